"""Closed-form kinematics of the three-revolute arm.

The shoulder turns about the vertical (yaw psi), then two links of equal length lie in the vertical plane at that yaw:
the upper arm at elevation theta_1, the forearm at elevation theta_1 + theta_2. With r the horizontal distance of the
gripper from the shoulder and h its height above it,

    r = L (cos theta_1 + cos(theta_1 + theta_2)),   h = L (sin theta_1 + sin(theta_1 + theta_2)).

For equal links the direction to the gripper halves the elbow angle: theta_1 + theta_2 / 2 = atan2(h, r) and
sqrt(r^2 + h^2) = 2 L cos(theta_2 / 2). The elbow is always kept above, theta_2 <= 0.

The gripper is the middle of a level bar across the arm with two rollers on it, pads 0 and 1. The rollers are round, so
that an item hangs below its pad whatever the pitch of the forearm: the arm needs no wrist.
"""

from __future__ import annotations

import math

Joints = tuple[float, float, float]
"""Shoulder yaw, shoulder pitch, elbow pitch, radians."""

Point = tuple[float, float, float]
"""A position in the robot's base frame, metres."""

SHOULDER: Point = (-0.15, 0.0, 0.80)
"""Where the axes of the shoulder meet, in the base frame."""

LINK_LENGTH = 0.56
"""From shoulder to elbow and from elbow to gripper, metres."""

PAD_OFFSETS = (0.07, -0.07)
"""Of pad 0 (medicine) and pad 1 (supplement) from the gripper along the bar, to the robot's left, metres."""

PAD_RADIUS = 0.02
"""Of a roller, metres: the top of an item hangs that much below the gripper."""

YAW_LIMIT = 1.6
"""Of the shoulder, to each side, radians."""

_SHOULDER_LIMITS = (-1.0, 2.2)
_ELBOW_LIMITS = (-2.8, 0.05)


def gripper_position(joints: Joints) -> Point:
    """Where the gripper is in the base frame at these joint angles."""
    yaw, shoulder, elbow = joints
    r = LINK_LENGTH * (math.cos(shoulder) + math.cos(shoulder + elbow))
    h = LINK_LENGTH * (math.sin(shoulder) + math.sin(shoulder + elbow))
    return SHOULDER[0] + r * math.cos(yaw), SHOULDER[1] + r * math.sin(yaw), SHOULDER[2] + h


def joints_for_gripper(p_BG: Point) -> Joints | None:
    """The joint angles that put the gripper at `p_BG`, elbow up; None when it is out of reach or not finite."""
    x, y, z = p_BG[0] - SHOULDER[0], p_BG[1] - SHOULDER[1], p_BG[2] - SHOULDER[2]
    r = math.hypot(x, y)
    half = math.hypot(r, z) / (2.0 * LINK_LENGTH)
    if not half <= 1.0:  # Also when it is NaN.
        return None
    bend = math.acos(half)
    joints = (math.atan2(y, x), math.atan2(z, r) + bend, -2.0 * bend)
    return joints if _within_limits(joints) else None


def _within_limits(joints: Joints) -> bool:
    yaw, shoulder, elbow = joints
    return (
        abs(yaw) <= YAW_LIMIT
        and _SHOULDER_LIMITS[0] <= shoulder <= _SHOULDER_LIMITS[1]
        and _ELBOW_LIMITS[0] <= elbow <= _ELBOW_LIMITS[1]
    )


def pad_position(joints: Joints, pad: int) -> Point:
    """Where the middle of roller `pad` is in the base frame at these joint angles."""
    x, y, z = gripper_position(joints)
    return x - PAD_OFFSETS[pad] * math.sin(joints[0]), y + PAD_OFFSETS[pad] * math.cos(joints[0]), z


def gripper_for_pad(p_BP: Point, pad: int) -> Point:
    """Where the gripper has to be for roller `pad` to be at `p_BP`.

    Seen from the shoulder the bar lies across the arm, so that pad, gripper and shoulder make a right angle:
    r_gripper^2 = r_pad^2 - offset^2, and the arm points past the pad by atan2(offset, r_gripper).

    Raises:
        ValueError: the pad would be nearer to the shoulder's axis than its own offset; no arm pose does that.
    """
    x, y, offset = p_BP[0] - SHOULDER[0], p_BP[1] - SHOULDER[1], PAD_OFFSETS[pad]
    r_squared = x * x + y * y - offset * offset
    if not r_squared > 0.0:
        raise ValueError(f"pad {pad} at {p_BP} is too near to the shoulder's axis")
    r = math.sqrt(r_squared)
    yaw = math.atan2(y, x) - math.atan2(offset, r)
    return SHOULDER[0] + r * math.cos(yaw), SHOULDER[1] + r * math.sin(yaw), p_BP[2]


STOWED_POSITION: Point = (0.17, 0.0, 0.95)
"""Of the gripper while driving: above the deck; elbow, bar and carried items stay within the hull's disc."""


def _stowed_joints() -> Joints:
    joints = joints_for_gripper(STOWED_POSITION)
    if joints is None:
        raise ValueError(f"the stowed position {STOWED_POSITION} is out of the arm's reach")
    return joints


STOWED: Joints = _stowed_joints()
"""Joint angles of the stowed arm."""
