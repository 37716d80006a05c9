"""The five criteria a plan is judged by, and what preference weights over them must be."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mala_drake.errors import BadInput

CRITERIA = ("time", "safety", "battery", "proximity", "approach")
"""The order of every feature, rating and weight vector (w0 ... w4)."""

UNIFORM_WEIGHTS = (1.0 / len(CRITERIA),) * len(CRITERIA)

_ROUNDING = 1e-6  # Of a sum of weights written as decimals.


def validated_weights(weights: Sequence[float], *, where: str = "weights") -> tuple[float, ...]:
    """The weights as a tuple of floats, once they are known to lie on the simplex.

    Args:
        weights: one number >= 0 a criterion, with the sum 1 (within 1e-6).
        where: names the file, option or field in the error.

    Raises:
        BadInput: if the number of weights, one of them or their sum is wrong.
    """
    if len(weights) != len(CRITERIA):
        raise BadInput(where, f"{len(weights)} weights", f"{len(CRITERIA)} ({', '.join(CRITERIA)})")
    for criterion, weight in zip(CRITERIA, weights, strict=True):
        if not (math.isfinite(weight) and weight >= 0.0):
            raise BadInput(f"{where}.{criterion}", str(weight), "a finite number >= 0")
    total = math.fsum(weights)
    if abs(total - 1.0) > _ROUNDING:
        raise BadInput(where, f"the sum of the weights is {total:g}", "1")
    return tuple(float(weight) for weight in weights)
