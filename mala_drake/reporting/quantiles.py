"""Medians and quartiles of figures that may be infinite: a run that never converged is later than any that did."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Spread:
    """A median and the quartiles round it; all NaN when there was no number."""

    median: float
    lower: float
    upper: float


def quantile(values: Iterable[float], fraction: float) -> float:
    """The quantile of `values` (numpy's linear one), where infinities stay infinite; NaN of no number.

    Args:
        values: NaN is left out.
        fraction: in [0, 1].
    """
    ordered = sorted(value for value in values if not math.isnan(value))
    if not ordered:
        return math.nan
    position = fraction * (len(ordered) - 1)
    below = math.floor(position)
    rest = position - below
    if rest == 0.0 or ordered[below] == ordered[below + 1]:
        return ordered[below]
    return ordered[below] + rest * (ordered[below + 1] - ordered[below])


def spread(values: Iterable[float]) -> Spread:
    """The median and the quartiles of `values`."""
    numbers = tuple(values)
    return Spread(quantile(numbers, 0.5), quantile(numbers, 0.25), quantile(numbers, 0.75))
