"""Choosing where to put boxes down: within reach, and clear of what stands there already."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from mala_drake.robot.arm_kinematics import Point, joints_for_gripper
from mala_drake.robot.arm_reach import NO_WAY, Way, way_to_reach_all
from mala_drake.robot.gripper_geometry import PlanarPose, gripper_to_hang_at, landing_positions
from mala_drake.robot.in_place_motions import HOVER_HEIGHT
from mala_drake.ward.items import ItemPose

CLEARANCE = 0.09
"""Metres that the centres of two boxes keep from each other; they are 0.08 m deep and 0.06 m wide."""

_DROP = 0.004  # Metres above the surface at which a box is let go, so that it is not pressed against it.


def work_goal(center: Point, base: PlanarPose, slot: int) -> Point | None:
    """Where in the base frame the gripper does its work on a box centred at the world point `center`.

    `slot` is that of the box, or -1 for the middle of a pair. None when the arm does not get there or above it.
    """
    goal = gripper_to_hang_at(center, base, slot)
    if goal is None:
        return None
    above = (goal[0], goal[1], goal[2] + HOVER_HEIGHT)
    return goal if joints_for_gripper(goal) is not None and joints_for_gripper(above) is not None else None


def way_to_work(center: Point, base: PlanarPose, slot: int) -> Way:
    """The way in the base frame that the base has to move for the gripper to work there, see `work_goal`.

    It is right to 0.04 m: the pads turn with the arm, and a robot that has moved stretches it in another direction.
    """
    goal = gripper_to_hang_at(center, base, slot)
    if goal is None:  # So near to the arm's axis that the pad's offset does not matter.
        goal = gripper_to_hang_at(center, base, -1)
    return NO_WAY if goal is None else way_to_reach_all((goal, (goal[0], goal[1], goal[2] + HOVER_HEIGHT)))


def way_to_spots(spots: Iterable[ItemPose], base: PlanarPose, slot: int) -> Way:
    """The shortest way in the base frame that the base has to move for one of the spots to be within reach."""
    ways = [way_to_work((spot.x, spot.y, spot.z + _DROP), base, slot) for spot in spots]
    return min(ways, key=lambda way: math.hypot(*way), default=NO_WAY)


def choose_spot(
    spots: Iterable[ItemPose], base: PlanarPose, slot: int, others: Sequence[Point]
) -> tuple[Point | None, bool]:
    """The first spot where box `slot` (-1: the pair) can be put down, as the gripper's goal in the base frame.

    Both pads come down together, so the room below the other pad counts as well.

    Args:
        spots: candidates, the best first.
        base: pose of the robot.
        slot: which box is put down.
        others: centres in the world of the boxes that are in the way.

    Returns:
        The goal or None, and whether any spot was within reach at all.
    """
    reachable = False
    for spot in spots:
        goal = work_goal((spot.x, spot.y, spot.z + _DROP), base, slot)
        landings = landing_positions(base, goal) if goal is not None else None
        if landings is None:
            continue
        reachable = True
        if all(math.dist(landing[:2], other[:2]) >= CLEARANCE for landing in landings for other in others):
            return goal, True
    return None, reachable
