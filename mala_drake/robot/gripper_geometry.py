"""Where boxes hang in the world, and where the gripper has to be for them to get somewhere.

The robot's base is level, so its pose in the world is (x, y, yaw).
"""

from __future__ import annotations

import math

from mala_drake.robot.arm_kinematics import (
    PAD_OFFSETS,
    PAD_RADIUS,
    Joints,
    Point,
    gripper_for_pad,
    joints_for_gripper,
    pad_position,
)
from mala_drake.ward.items import ITEM_HALF_HEIGHT

PlanarPose = tuple[float, float, float]
"""x and y in metres, yaw in radians, in the world."""

HANGING_DEPTH = PAD_RADIUS + ITEM_HALF_HEIGHT
"""Metres from the gripper down to the centre of a box at its pad."""


def in_base(point: Point, base: PlanarPose) -> Point:
    """The world point `point` in the frame of the robot's base."""
    dx, dy = point[0] - base[0], point[1] - base[1]
    cosine, sine = math.cos(base[2]), math.sin(base[2])
    return cosine * dx + sine * dy, cosine * dy - sine * dx, point[2]


def in_world(point: Point, base: PlanarPose) -> Point:
    """The point `point` of the robot's base frame in the world."""
    cosine, sine = math.cos(base[2]), math.sin(base[2])
    return base[0] + cosine * point[0] - sine * point[1], base[1] + sine * point[0] + cosine * point[1], point[2]


def hanging_positions(base: PlanarPose, joints: Joints) -> tuple[Point, ...]:
    """The centres in the world of boxes that hang at each pad, at these joint angles."""
    positions = []
    for pad in range(len(PAD_OFFSETS)):
        x, y, z = in_world(pad_position(joints, pad), base)
        positions.append((x, y, z - HANGING_DEPTH))
    return tuple(positions)


def gripper_to_hang_at(center: Point, base: PlanarPose, slot: int) -> Point | None:
    """Where in the base frame the gripper is when the box at pad `slot` has its centre at the world point `center`.

    With `slot` -1 it is the middle of the pair of boxes that comes to `center`. None when it is too near to the arm's
    own axis; whether the arm reaches that far is not looked at.
    """
    x, y, z = in_base(center, base)
    above = (x, y, z + HANGING_DEPTH)
    if slot < 0:
        return above
    try:
        return gripper_for_pad(above, slot)
    except ValueError:
        return None


def landing_positions(base: PlanarPose, p_BG: Point) -> tuple[Point, ...] | None:
    """The centres in the world of boxes that hang at each pad when the gripper is at `p_BG`; None out of reach."""
    joints = joints_for_gripper(p_BG)
    return None if joints is None else hanging_positions(base, joints)
