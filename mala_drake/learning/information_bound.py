"""How well preference weights can be known at all: the Cramer-Rao bound with the simplex constraint.

A rating r_i = 5 - 4 f_i w_i + eps_i with eps_i ~ N(0, sigma^2) carries the information 16 f_i^2 / sigma^2 about w_i.
The weights sum to one, so only directions within the simplex are uncertain: with U an orthonormal basis of the vectors
that sum to zero and J the information, the covariance of an unbiased estimate is at least U (U' J U)^-1 U' (Stoica &
Ng, "On the Cramer-Rao bound under parametric constraints", 1998).

J is diagonal, so U' J U is singular where two weights or more are not rated at all. Of these only the sum is known, as
what the others leave; it tells nothing of the others, which are known as without the constraint.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput

FloatArray = npt.NDArray[np.float64]


def sum_zero_basis(size: int) -> FloatArray:
    """An orthonormal basis of the vectors that sum to zero, as columns: (size, size - 1)."""
    basis = np.zeros((size, size - 1))
    for k in range(1, size):
        basis[:k, k - 1] = 1.0
        basis[k, k - 1] = -float(k)
        basis[:, k - 1] /= np.sqrt(k * (k + 1.0))
    return basis


def weight_bound(features: npt.ArrayLike, noise: float) -> FloatArray:
    """The least standard deviation of each weight's estimate.

    Args:
        features: measured f of the rated episodes, shape (episodes, criteria); NaN where a criterion was not rated.
        noise: sigma, the standard deviation of a rating, > 0.

    Returns:
        One number a criterion; infinite for weights of which nothing tells more than their sum with others.

    Raises:
        BadInput: if the noise is not positive or the features are not a table.
    """
    table = np.nan_to_num(np.asarray(features, dtype=float))
    if not noise > 0.0:
        raise BadInput("noise", str(noise), "a standard deviation > 0")
    if table.ndim != 2:
        raise BadInput("features", f"shape {table.shape}", "(episodes, criteria)")
    size = table.shape[1]
    basis = sum_zero_basis(size)
    told = (16.0 / noise**2) * (table**2).sum(axis=0)
    information = basis.T @ (told[:, None] * basis)
    if np.linalg.matrix_rank(information) < size - 1:
        unseen = told <= np.sort(told)[1]  # At least two.
        return np.where(unseen, np.inf, 1.0 / np.sqrt(np.where(unseen, 1.0, told)))
    covariance = basis @ np.linalg.solve(information, basis.T)
    return np.sqrt(np.diag(covariance))


def efficiency(errors: Sequence[npt.ArrayLike], bounds: Sequence[npt.ArrayLike]) -> float:
    """Root mean square, over runs and weights, of error over bound: 1 for an efficient unbiased estimate.

    Args:
        errors: estimate minus truth of each run, one number a criterion.
        bounds: of each run, from `weight_bound`.
    """
    return float(np.sqrt(np.mean((np.asarray(errors, dtype=float) / np.asarray(bounds, dtype=float)) ** 2)))
