"""The set of defuzzifications D^iota: from degrees of truth to true and false."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput

BoolArray = npt.NDArray[np.bool_]

INSTANTIATION_THRESHOLD = 0.7
"""A degree at which an atom is taken as true (paper, Sec. "Fuzzy State Estimation")."""


class AbstractDefuzzification(ABC):
    """One operation D^iota (paper, Sec. "Updating the Planning State and Model").

    Degrees that are not numbers (NaN) are never true.
    """

    __slots__ = ()

    @abstractmethod
    def crisp(self, values: npt.ArrayLike, *, previous: npt.ArrayLike | None = None) -> BoolArray:
        """The crisp truth of each atom.

        Args:
            values: degrees of truth, (M,).
            previous: the crisp truth before, (M,), for operations with a memory; None stands for all false.
        """


@dataclass(frozen=True, slots=True)
class Threshold(AbstractDefuzzification):
    """Each atom for itself: true from the threshold up."""

    threshold: float = INSTANTIATION_THRESHOLD

    def __post_init__(self) -> None:
        _require_degree("Threshold.threshold", self.threshold)

    def crisp(self, values: npt.ArrayLike, *, previous: npt.ArrayLike | None = None) -> BoolArray:  # noqa: ARG002
        """Whether each degree is at least the threshold; without memory."""
        return np.asarray(values, dtype=float) >= self.threshold


@dataclass(frozen=True, slots=True)
class ArgmaxThreshold(AbstractDefuzzification):
    """Among atoms that exclude each other: the one with the highest degree, if that reaches the threshold.

    Of equal degrees the first one wins. With locations this is l_fuzzy, and all false means "in transit".
    """

    threshold: float = INSTANTIATION_THRESHOLD

    def __post_init__(self) -> None:
        _require_degree("ArgmaxThreshold.threshold", self.threshold)

    def crisp(self, values: npt.ArrayLike, *, previous: npt.ArrayLike | None = None) -> BoolArray:  # noqa: ARG002
        """At most one true; without memory."""
        degrees = np.nan_to_num(np.asarray(values, dtype=float), nan=-math.inf)
        truths = np.zeros(degrees.shape, dtype=bool)
        if degrees.size > 0:
            best = int(np.argmax(degrees))
            truths[best] = degrees[best] >= self.threshold
        return truths


@dataclass(frozen=True, slots=True)
class Hysteresis(AbstractDefuzzification):
    """Becomes true at `upper` and stays true down to `lower`, so that noise at one threshold makes no flicker."""

    lower: float = 0.5
    upper: float = INSTANTIATION_THRESHOLD

    def __post_init__(self) -> None:
        _require_degree("Hysteresis.lower", self.lower)
        _require_degree("Hysteresis.upper", self.upper)
        if self.lower > self.upper:
            raise BadInput("Hysteresis.lower", str(self.lower), f"at most upper = {self.upper}")

    def crisp(self, values: npt.ArrayLike, *, previous: npt.ArrayLike | None = None) -> BoolArray:
        """True where the degree reaches `upper`, or reaches `lower` and was true before."""
        degrees = np.asarray(values, dtype=float)
        before = np.zeros(degrees.shape, dtype=bool) if previous is None else np.asarray(previous, dtype=bool)
        return (degrees >= self.upper) | (before & (degrees >= self.lower))


def _require_degree(where: str, degree: float) -> None:
    if not 0.0 < degree <= 1.0:
        raise BadInput(where, str(degree), "a degree of truth in (0, 1]")
