"""Congestion of the ward: risk and speed along a path.

The planner's risk of a transition and the risk that the robot collects while it drives are both the integral of the
congestion level over the path, so that prediction and measurement mean one thing.
"""

from __future__ import annotations

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
        # The highest level counts, so the zones are looked at in rising order and later ones overwrite.
        zones = sorted(ward.zones, key=lambda zone: (zone.level, zone.name))
        self._levels = [zone.level for zone in zones]
        self._polygons = [shapely.Polygon(zone.polygon) for zone in zones]
        for polygon in self._polygons:
            shapely.prepare(polygon)

    def level(self, points: ArrayLike) -> NDArray[np.float64]:
        """Levels in (0, 1), shape (...), at `points` with shape (..., 2) in metres."""
        points = np.asarray(points, dtype=float)
        levels = np.full(points.shape[:-1], self._background)
        for level, polygon in zip(self._levels, self._polygons, strict=True):
            levels[shapely.contains_xy(polygon, points[..., 0], points[..., 1])] = max(level, self._background)
        return levels

    def speed_limit(self, points: ArrayLike) -> NDArray[np.float64]:
        """Metres per second allowed at `points`: cruise / (1 + level)."""
        return CRUISE_SPEED / (1.0 + self.level(points))

    def risk(self, points: ArrayLike) -> float:
        """Risk rho of the polyline `points`, shape (n, 2): the integral of the level over `RISK_LENGTH`."""
        middles, lengths = sample(points)
        return float(self.level(middles) @ lengths / RISK_LENGTH)

    def travel_time(self, points: ArrayLike) -> float:
        """Seconds along the polyline at the speed limit."""
        middles, lengths = sample(points)
        return float(np.sum(lengths / self.speed_limit(middles)))


def sample(points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cuts a polyline into short pieces: their middles, shape (m, 2), and lengths, shape (m,), in metres."""
    corners = np.asarray(points, dtype=float)
    middles, lengths = [np.empty((0, 2))], [np.empty(0)]
    for a, b in pairwise(corners):
        length = float(np.hypot(*(b - a)))
        count = max(1, int(np.ceil(length / _SAMPLE)))
        fractions = (np.arange(count) + 0.5) / count
        middles.append(a + fractions[:, None] * (b - a))
        lengths.append(np.full(count, length / count))
    return np.concatenate(middles), np.concatenate(lengths)
