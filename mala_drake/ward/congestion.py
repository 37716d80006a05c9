"""Congestion of the ward: risk and speed along a path.

The planner's risk of a transition and the risk that the robot collects while it drives are both the integral of the
congestion level over the path, so that prediction and measurement mean one thing.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from mala_drake.ward.ward_map import Ward

CRUISE_SPEED = 1.5
"""Metres per second where nobody is about."""

RISK_LENGTH = 40.0
"""Metres of path at level 1 that count as risk 1: keeps the risk of every transition in (0, 1)."""

_SAMPLE = 0.05  # Metres between samples of a path.


class Congestion:
    """Looks up congestion levels of a ward."""

    def __init__(self, ward: Ward) -> None:
        self._background = ward.background_congestion
        self._levels = np.array([max(zone.level, self._background) for zone in ward.zones])
        self._polygons = np.array([shapely.Polygon(zone.polygon) for zone in ward.zones], dtype=object)
        shapely.prepare(self._polygons)

    def level(self, points: ArrayLike) -> NDArray[np.float64]:
        """Levels in (0, 1), shape (...), at `points` with shape (..., 2) in metres: the highest of all zones there."""
        points = np.asarray(points, dtype=float)
        inside = shapely.contains_xy(self._polygons, points[..., 0, None], points[..., 1, None])
        levels: NDArray[np.float64] = np.where(inside, self._levels, self._background).max(-1, initial=self._background)
        return levels

    def speed_limit(self, points: ArrayLike) -> NDArray[np.float64]:
        """Metres per second allowed at `points`: cruise / (1 + level)."""
        return CRUISE_SPEED / (1.0 + self.level(points))

    def risk(self, points: ArrayLike) -> float:
        """Risk rho of the polyline `points`, shape (n, 2): the integral of the level over `RISK_LENGTH`."""
        middles, lengths = sample(points)
        return float(self.level(middles) @ lengths / RISK_LENGTH)


def sample(points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cuts a polyline into short pieces: their middles, shape (m, 2), and lengths, shape (m,), in metres."""
    corners = np.asarray(points, dtype=float)
    if len(corners) == 2:
        return _sample_line(*corners)
    middles, lengths = [np.empty((0, 2))], [np.empty(0)]
    for start, end in pairwise(corners):
        of_line = _sample_line(start, end)
        middles.append(of_line[0])
        lengths.append(of_line[1])
    return np.concatenate(middles), np.concatenate(lengths)


def _sample_line(
    start: NDArray[np.float64], end: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    step = end - start
    length = float(np.hypot(step[0], step[1]))
    count = max(1, math.ceil(length / _SAMPLE))
    fractions = (np.arange(count) + 0.5) / count
    return start + fractions[:, None] * step, np.full(count, length / count)
