"""Layout of the care robot's own state port (`care_robot_state`): 9 positions, then 8 velocities.

The base is a floating body with Drake's quaternion joint, all of it expressed in the world frame. The systems that run
at the plant's rate index by these constants instead of a named view, which would cost more than their arithmetic.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

QW, QX, QY, QZ, X, Y, Z, LEFT_WHEEL_ANGLE, RIGHT_WHEEL_ANGLE = range(9)
OMEGA_X, OMEGA_Y, OMEGA_Z, V_X, V_Y, V_Z, LEFT_WHEEL_SPEED, RIGHT_WHEEL_SPEED = range(9, 17)

PLANT_STATE_SIZE = 17

BASE_VELOCITIES = 6
"""Velocities of the base: angular, then translational; its generalized force is a torque, then a force."""


def yaw_of(state: Sequence[float]) -> float:
    """The heading of the base in [-pi, pi], radians: the direction of its x axis seen from above."""
    qw, qx, qy, qz = state[QW], state[QX], state[QY], state[QZ]
    # Holds for a quaternion of any norm: the discrete plant lets it drift while the robot turns.
    return math.atan2(2.0 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz)


def planar_state_of(state: Sequence[float]) -> tuple[float, float, float, float, float, float]:
    """The state of the controller's model: x, y, yaw, v_x, v_y, omega_z.

    Position in metres and yaw in [-pi, pi] are those of the base frame in the world; the velocity of its origin, m/s,
    is expressed along the heading and to its left; the yaw rate is in rad/s.
    """
    yaw = yaw_of(state)
    cos, sin = math.cos(yaw), math.sin(yaw)
    v_x, v_y = state[V_X], state[V_Y]
    return state[X], state[Y], yaw, cos * v_x + sin * v_y, cos * v_y - sin * v_x, state[OMEGA_Z]
