"""The nearest point of a box, where distance is that of a normal distribution."""

from __future__ import annotations

import numpy as np

from mala_drake.learning.abstract_learner import FloatArray

_ROUNDING = 1e-9  # Of a standard deviation: an entry that near a bound is on it.
_MOST_STEPS = 50  # A dozen are needed at most, unless P is singular but for rounding.


def nearest_in_box(mean: FloatArray, covariance: FloatArray, lowest: FloatArray, highest: FloatArray) -> FloatArray:
    """The most likely x with lowest <= x <= highest under the normal distribution N(mean, P).

    That is argmin (x - mean)' P^-1 (x - mean) over the box. By its optimality conditions x = mean + P f, with a force
    f_i that pushes inward on an active bound and is zero elsewhere. One active bound b, of entry i, acts like an exact
    measurement of that entry, x = mean + P[:, i] (b - mean_i) / P[i, i]: what is correlated with it moves too.

    The forces are found by a dual active-set method (D. Goldfarb, A. Idnani, Mathematical Programming 27, 1983), which
    inverts nothing but the active part of P.

    Args:
        mean: shape (n,).
        covariance: P, symmetric and positive definite, shape (n, n).
        lowest: shape (n,).
        highest: above `lowest`, shape (n,).
    """
    nearest, forces = mean.copy(), np.zeros(mean.size)
    slack = _ROUNDING * np.sqrt(np.diag(covariance))
    active: list[int] = []
    for _ in range(_MOST_STEPS):
        missing = np.clip(nearest, lowest, highest) - nearest
        missing[active] = 0.0
        new = int(np.argmax(np.abs(missing) / slack))
        if abs(missing[new]) <= slack[new]:
            break
        bound = nearest[new] + missing[new]
        while new not in active:
            # One unit of the new force, and what it takes of the others to keep them on their bounds.
            unit = np.zeros(mean.size)
            unit[new] = 1.0
            unit[active] = -np.linalg.solve(covariance[np.ix_(active, active)], covariance[active, new])
            needed = unit * (bound - nearest[new]) / (covariance[new] @ unit)
            # No force may come to push outward: the first that would is let go where it vanishes.
            shares = [-forces[i] / needed[i] if forces[i] * needed[i] < 0.0 else np.inf for i in active]
            share = min([1.0, *shares])
            forces += share * needed
            if share < 1.0:
                forces[active.pop(int(np.argmin(shares)))] = 0.0
            else:
                active.append(new)
            nearest = mean + covariance @ forces
    return np.clip(nearest, lowest, highest)
