"""From accelerations to wheel torques, and what they cost: the pure part of the drivetrain."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from mala_drake.clock import PLANT_STEP
from mala_drake.robot.robot_parameters import NOMINAL, RobotParameters

_BRAKE_SOFTNESS = 0.5
"""Share of a motion that a held brake takes away in one plant step; 1 would be dead beat on the nominal robot."""


@dataclass(frozen=True, slots=True)
class DriveLaw:
    """Nominal inverse dynamics of the two wheels, rolling resistance compensated, with a passive brake.

    All its numbers are nominal: mass, inertia and radius may be wrong for the robot it drives.
    """

    parameters: RobotParameters = NOMINAL
    _per_wheel: float = field(init=False, repr=False)  # Torque of a wheel per forward acceleration.
    _per_turn: float = field(init=False, repr=False)  # The same per yaw acceleration.

    def __post_init__(self) -> None:
        p = self.parameters
        object.__setattr__(self, "_per_wheel", 0.5 * p.effective_mass * p.wheel_radius)
        object.__setattr__(self, "_per_turn", 0.5 * p.effective_yaw_inertia * p.wheel_radius / p.half_track)

    def torques(
        self,
        propulsion: float,
        brake: float,
        yaw_acceleration: float,
        left_speed: float,
        right_speed: float,
        *,
        powered: bool = True,
    ) -> tuple[float, float]:
        """The torques of the left and the right wheel, N m.

        The brake works against the forward motion that it finds and never pushes back beyond rest: near rest it is a
        viscous friction of a strength that one plant step cannot overshoot. A command of nothing but braking is the
        parking brake, which also holds each wheel for itself. A command that is not finite, and a drive without power
        (`powered` false: an empty battery), park at full brake.

        Args:
            propulsion: forward acceleration, m/s^2; negative pushes backward.
            brake: deceleration, m/s^2, not negative.
            yaw_acceleration: rad/s^2, positive to the left.
            left_speed: of the left wheel, rad/s.
            right_speed: of the right wheel, rad/s.
            powered: whether the motors may push.
        """
        p = self.parameters
        if not (powered and math.isfinite(propulsion + brake + yaw_acceleration)):
            propulsion, brake, yaw_acceleration = 0.0, p.brake_limit, 0.0
        brake = min(max(brake, 0.0), p.brake_limit)
        per_wheel, limit = self._per_wheel, p.torque_limit
        grip = _BRAKE_SOFTNESS * per_wheel * p.wheel_radius / PLANT_STEP
        bound = per_wheel * brake
        if propulsion == 0.0 and yaw_acceleration == 0.0 and brake > 0.0:
            # The rolling resistance brakes too; the parking brake adds what is missing.
            left_bound = max(0.0, min(bound, limit) - p.wheel_damping * abs(left_speed))
            right_bound = max(0.0, min(bound, limit) - p.wheel_damping * abs(right_speed))
            return -_clip(grip * left_speed, left_bound), -_clip(grip * right_speed, right_bound)
        forward = per_wheel * _clip(propulsion, p.propulsion_limit)
        forward -= _clip(grip * 0.5 * (left_speed + right_speed), bound)
        turn = _clip(yaw_acceleration, p.yaw_acceleration_limit) * self._per_turn
        return (
            _clip(forward - turn + p.wheel_damping * left_speed, limit),
            _clip(forward + turn + p.wheel_damping * right_speed, limit),
        )

    def power(self, torques: tuple[float, float], left_speed: float, right_speed: float) -> float:
        """The electrical power of the drive, W.

        A motor draws its mechanical power over the efficiency and the heat of its current; a torque against the motion
        is friction of the brake, which neither costs nor returns anything.
        """
        p = self.parameters
        power = 0.0
        for torque, speed in ((torques[0], left_speed), (torques[1], right_speed)):
            if torque * speed >= 0.0:
                power += torque * speed / p.drive_efficiency + p.copper_loss * torque * torque
        return power

    def cruise_power(self, speed: float) -> float:
        """The electrical power of driving straight at a constant speed (m/s) against the rolling resistance, W."""
        spin = speed / self.parameters.wheel_radius
        torque = self.parameters.wheel_damping * spin
        return self.power((torque, torque), spin, spin)


def _clip(value: float, bound: float) -> float:
    return bound if value > bound else -bound if value < -bound else value
