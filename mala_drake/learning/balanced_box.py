"""The Euclidean projection onto what is bounded and sums to zero."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from mala_drake.errors import BadInput
from mala_drake.learning.abstract_learner import FloatArray


def project_to_balanced_box(point: ArrayLike, lowest: float, highest: float) -> FloatArray:
    """The nearest x to `point` with sum(x) = 0 and every entry between `lowest` and `highest`.

    By the optimality conditions x = clip(point - shift), with the shift at which the sum vanishes. The sum falls
    piecewise linearly with the shift, with corners where an entry reaches a bound.

    Args:
        point: finite, shape (n,), n >= 1.
        lowest: <= 0.
        highest: >= 0.

    Raises:
        BadInput: there is no such x, or the point is not finite.
    """
    values = np.asarray(point, dtype=float)
    if not lowest <= 0.0 <= highest:
        raise BadInput("bounds", f"{lowest}, {highest}", "lowest <= 0 <= highest")
    if not np.isfinite(values).all():
        raise BadInput("point", str(values), "finite numbers")
    corners = np.unique(np.concatenate((values - highest, values - lowest)))
    sums = np.clip(values - corners[:, None], lowest, highest).sum(axis=1)  # Falling.
    shift = float(np.interp(0.0, sums[::-1], corners[::-1]))
    return np.clip(values - shift, lowest, highest)
