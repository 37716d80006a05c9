"""The shortest step in the plane that goes far enough in each of some directions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

_ROUNDING = 1e-9  # Metres.


def shortest_step(demands: Sequence[Vector]) -> Vector:
    """The shortest s, (2,), with d . s >= d . d for each of `demands` d: the projection of 0 onto their half-planes.

    It is found among the demands themselves and the corners between two of them, where the projection must lie. Where
    the half-planes have nothing in common it is the longest demand.
    """
    if not demands:
        return np.zeros(2)
    common = [step for step in _candidates(demands) if all(d @ step >= d @ d - _ROUNDING for d in demands)]
    if common:
        return min(common, key=np.linalg.norm)
    return max(demands, key=np.linalg.norm)


def _candidates(demands: Sequence[Vector]) -> Iterator[Vector]:
    yield from demands
    for pair in combinations(demands, 2):
        rows = np.array(pair)
        if abs(np.linalg.det(rows)) > _ROUNDING:
            yield np.linalg.solve(rows, (rows * rows).sum(axis=1))
