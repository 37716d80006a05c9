"""The charge that driving takes, as a smooth function of how the robot moves and what it is told.

It is the power of `DriveLaw` with its cases rounded off: a brake works against the motion, a torque against the motion
costs nothing.
"""

from __future__ import annotations

import casadi

from mala_drake.robot.battery import CAPACITY
from mala_drake.robot.robot_parameters import NOMINAL, RobotParameters

_REST = 0.05  # m/s over which the brake's direction changes.
_SMALL = 0.5  # W over which a motor begins to cost.


def charge_rate(
    motion: tuple[casadi.SX, casadi.SX],
    command: tuple[casadi.SX, casadi.SX, casadi.SX],
    *,
    parameters: RobotParameters = NOMINAL,
    capacity: float = CAPACITY,
) -> casadi.SX:
    """State of charge used per second.

    Args:
        motion: forward velocity, m/s, and yaw rate, rad/s.
        command: propulsion and brake, m/s^2, and yaw acceleration, rad/s^2.
        parameters: of the robot.
        capacity: of its battery, J.
    """
    p = parameters
    speed, yaw_rate = motion
    propulsion, brake, yaw_acceleration = command
    braking = brake * casadi.tanh(speed / _REST)
    forward = 0.5 * p.effective_mass * p.wheel_radius * (propulsion - braking)
    turn = 0.5 * p.effective_yaw_inertia * p.wheel_radius / p.half_track * yaw_acceleration
    power = 0.0
    for side in (-1.0, 1.0):
        spin = (speed + side * p.half_track * yaw_rate) / p.wheel_radius
        torque = forward + side * turn + p.wheel_damping * spin
        mechanical = torque * spin
        driving = 0.5 * (1.0 + mechanical / casadi.sqrt(mechanical**2 + _SMALL**2))  # 0 for a brake, 1 for a motor.
        power += driving * (mechanical / p.drive_efficiency + p.copper_loss * torque**2)
    return power / capacity
