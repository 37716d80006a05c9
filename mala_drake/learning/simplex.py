"""The probability simplex: Euclidean projection onto it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


def project_onto_simplex(point: npt.ArrayLike) -> FloatArray:
    """The point of the simplex {w >= 0, sum w = 1} nearest to `point`, exact up to rounding.

    By the optimality conditions w_i = max(point_i - threshold, 0) with one threshold for all entries; sorting finds
    how many entries stay positive (Held, Wolfe and Crowder, "Validation of subgradient optimization", 1974).

    Args:
        point: (n,), finite, n >= 1.

    Raises:
        ValueError: if the point is empty, not a vector or not finite.
    """
    vector = np.asarray(point, dtype=float)
    if vector.ndim != 1 or vector.size == 0 or not np.all(np.isfinite(vector)):
        raise ValueError(f"cannot project {point!r} onto the simplex: expected a non-empty vector of finite numbers")
    # The projection does not change when all entries are shifted; near 0 the sums below lose no digits.
    shifted = vector - vector.max()
    descending = np.sort(shifted)[::-1]
    thresholds = (np.cumsum(descending) - 1.0) / np.arange(1, vector.size + 1)
    positive = np.count_nonzero(descending > thresholds)
    return np.maximum(shifted - thresholds[positive - 1], 0.0)
