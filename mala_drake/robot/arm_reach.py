"""How far the arm falls short: the least way that the base has to move for the gripper to reach a point.

At the heights that the robot works at, the gripper surely reaches a sector of an annulus round the shoulder's axis:
from `NEAREST` to the stretched arm, between the limits of the shoulder's yaw. The way is that from the sector's nearest
point to the one that is wanted.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from mala_drake.robot.arm_kinematics import LINK_LENGTH, SHOULDER, YAW_LIMIT, Point, joints_for_gripper

Way = tuple[float, float]
"""(dx, dy), metres."""

NO_WAY: Way = (0.0, 0.0)

NEAREST = 0.4
"""Metres from the shoulder's axis from which on the limits of the elbow and of the shoulder's pitch do not bind."""


def way_to_reach(p_BG: Point) -> Way:
    """The way (dx, dy) in the base frame that the base has to move, without turning, for the gripper to reach `p_BG`.

    It is zero where the gripper gets there already.
    """
    if joints_for_gripper(p_BG) is not None:
        return NO_WAY
    x, y, height = p_BG[0] - SHOULDER[0], p_BG[1] - SHOULDER[1], p_BG[2] - SHOULDER[2]
    longest = math.sqrt(max((2.0 * LINK_LENGTH) ** 2 - height**2, 0.0))
    yaw = min(max(math.atan2(y, x), -YAW_LIMIT), YAW_LIMIT)
    ahead, aside = math.cos(yaw), math.sin(yaw)
    radius = min(max(x * ahead + y * aside, min(NEAREST, longest)), longest)
    return x - radius * ahead, y - radius * aside


def way_to_reach_all(points: Iterable[Point]) -> Way:
    """The longest of the ways to several points; zero for none."""
    return max((way_to_reach(point) for point in points), key=lambda way: math.hypot(*way), default=NO_WAY)
