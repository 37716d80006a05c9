"""Legs between named places: the route to a pose, driven straight into it at the end."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache

import numpy as np

from mala_drake.messages import Shape
from mala_drake.ward.routes import Route, RoutePlanner
from mala_drake.ward.ward_map import Ward

_RUN_IN = 0.9
"""Metres of straight approach before a place, along its yaw: a differential drive does not reach a pose sideways."""

_THERE = 1e-3  # Metres within which a point is the goal.


class LegPlanner:
    """Plans legs on one ward. Places are poses; the run-in is left out where there is no room for it."""

    def __init__(self, ward: Ward) -> None:
        self._ward = ward
        self._planner = RoutePlanner(ward.shapes)

    def to_pose(
        self, start: tuple[float, float], pose: tuple[float, float, float], *, unmapped: Iterable[Shape] = ()
    ) -> Route | None:
        """The route from `start` to the pose (x, y, yaw), or None when there is none."""
        unmapped = tuple(unmapped)
        x, y, yaw = pose
        goal = (x, y)
        if math.dist(start, goal) < _THERE:
            # Already there: what is left is to turn, on a path that has a direction.
            start = (x - _THERE * math.cos(yaw), y - _THERE * math.sin(yaw))
        entry = (x - _RUN_IN * math.cos(yaw), y - _RUN_IN * math.sin(yaw))
        direct = self._planner.route(start, goal, unmapped=unmapped)
        if math.dist(start, goal) < 2 * _RUN_IN or not self._planner.segment_is_free(entry, goal, unmapped=unmapped):
            return direct
        around = self._planner.route(start, entry, unmapped=unmapped)
        if around is None or direct is None or around.length + _RUN_IN > direct.length + 2 * _RUN_IN:
            return direct
        points = np.vstack((around.points, goal))
        points.setflags(write=False)
        return Route(points)

    def between(self, start: str, goal: str) -> Route | None:
        """The leg between two named places of the map."""
        a, b = self._ward.place[start], self._ward.place[goal]
        return self.to_pose((a.x, a.y), (b.x, b.y, b.yaw))


@lru_cache(maxsize=4)
def leg_planner(ward: Ward) -> LegPlanner:
    """The leg planner of a ward, made once (its visibility graphs take a moment)."""
    return LegPlanner(ward)
