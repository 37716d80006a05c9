"""The drives of `bench mpc`: an obstacle course, and the legs of the ward on which obstacles matter most."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from mala_drake.control.reference import Track
from mala_drake.messages import Shape
from mala_drake.robot.line_of_sight import LineOfSight
from mala_drake.robot.obstacle_sensor import RANGE
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.drive_path import make_drive_path
from mala_drake.ward.legs import leg_planner
from mala_drake.ward.routes import BODY_RADIUS, RoutePlanner
from mala_drake.ward.shapes import ShapeDistances
from mala_drake.ward.ward_map import LoadWard, Ward

from .model_drive import Drive, steps_for

MAPPED = (
    Shape("cabinet", 3.0, 0.2, 0.3, half_length=0.45, half_width=0.35, radius=0.05),
    Shape("partition", 5.0, -1.6, 0.0, half_length=0.1, half_width=1.2),
    Shape("pillar", 6.6, 0.9, radius=0.4),
    Shape("trolley", 4.4, 1.9, 0.4, half_length=0.5, half_width=0.3, radius=0.02),
    Shape("bed", 9.0, -0.9, -0.5, half_length=1.1, half_width=0.5, radius=0.1),
    Shape("desk", 8.6, 2.3, 0.1, half_length=0.7, half_width=0.4),
    Shape("wall", 5.0, 3.4, 0.0, half_length=6.0, half_width=0.1),
)
UNMAPPED = Shape("bucket", 1.6, -0.85, radius=0.18)
START, GOAL = (0.0, 0.0), (11.0, 0.6, 0.4)

_EMPTY_WARD = Ward("course", 50.0, 0.2, 2.0, (), (), (), 0.02)
_PASSING = 0.3  # Metres between body and shape within which a shape counts as passed.
_AT_ENDS = 0.6  # Metres at either end of a leg that do not count: furniture always stands there.


def course() -> Drive:
    """A course that fills all eight obstacle slots.

    The reference comes from a route round seven of them; the eighth stands at its edge and only the solver avoids it.
    """
    route = RoutePlanner(MAPPED).route(START, GOAL[:2])
    if route is None:
        raise AssertionError("the course has a route by construction")
    congestion, shapes = Congestion(_EMPTY_WARD), (*MAPPED, UNMAPPED)
    track = Track(make_drive_path(route, congestion), GOAL[2])
    return Drive("course", track, 0.0, shapes, lambda *_: shapes, congestion, steps_for(track, 0.0))


def hard_legs(ward: Ward | None = None, *, count: int = 6) -> list[Drive]:
    """The legs between places of the ward on which the robot passes most shapes closely, the narrowest first.

    Legs are ranked by the number of shapes passed within `_PASSING`, then by the least clearance of their path. No
    place is the start, or the goal, of two of them.
    """
    ward = ward or LoadWard()
    distances = ShapeDistances(ward.shapes)
    ranked = []
    for start, goal in permutations([place.name for place in ward.places], 2):
        route = leg_planner(ward).between(start, goal)
        if route is None:
            continue
        path = make_drive_path(route, Congestion(ward))
        middle = (path.lengths > _AT_ENDS) & (path.lengths < path.length - _AT_ENDS)
        if not middle.any():
            continue
        gaps = distances(path.points[middle]).min(axis=0) - BODY_RADIUS
        ranked.append((-int((gaps < _PASSING).sum()), float(gaps.min()), start, goal))
    chosen: dict[str, str] = {}
    for _, _, start, goal in sorted(ranked):
        if len(chosen) < count and start not in chosen and goal not in chosen.values():
            chosen[start] = goal
    return [ward_leg(ward, start, goal) for start, goal in chosen.items()]


def ward_leg(ward: Ward, start: str, goal: str) -> Drive:
    """The leg between two places, as the robot's sensor shows it.

    Raises:
        ValueError: the ward has no free way between them.
    """
    route = leg_planner(ward).between(start, goal)
    if route is None:
        raise ValueError(f"no free way from {start} to {goal}")
    congestion, yaw = Congestion(ward), ward.place[start].yaw
    track = Track(make_drive_path(route, congestion), ward.place[goal].yaw)
    sight, shapes = LineOfSight(ward.shapes, reach=RANGE), ward.shapes

    def seen(x: float, y: float) -> tuple[Shape, ...]:
        return tuple(shapes[i] for i in np.flatnonzero(sight.visible(x, y)))

    return Drive(f"{start} -> {goal}", track, yaw, shapes, seen, congestion, steps_for(track, yaw))
