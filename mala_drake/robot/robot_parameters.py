"""The nominal numbers of the care robot: what its own drivetrain, battery and monitors believe about the model.

They describe `models/care_robot.sdf` (a test compares the two). The plant may differ from them on purpose, see
`mala_drake.robot.hidden_truth`.
"""

from __future__ import annotations

from dataclasses import dataclass

from mala_drake.ward.routes import BODY_RADIUS


@dataclass(frozen=True, slots=True)
class RobotParameters:
    """Mass properties, geometry and limits of the drive. SI units."""

    mass: float = 40.0  # kg, everything included.
    yaw_inertia: float = 1.25  # kg m^2, of the whole robot about the vertical through the axle, arm stowed.
    wheel_radius: float = 0.1  # m.
    half_track: float = 0.18  # m, from the middle of the axle to a wheel.
    wheel_inertia: float = 0.006  # kg m^2, of one wheel about its axle.
    wheel_damping: float = 0.0667  # N m s/rad, of one wheel: a rolling resistance of 20 N at 1.5 m/s.
    torque_limit: float = 8.0  # N m, of one wheel.
    body_radius: float = BODY_RADIUS  # m, of the hull seen from above.
    propulsion_limit: float = 2.0  # m/s^2, forward and backward.
    brake_limit: float = 2.0  # m/s^2.
    yaw_acceleration_limit: float = 1.0  # rad/s^2.
    drive_efficiency: float = 0.85  # Mechanical over electrical power of the drive.
    copper_loss: float = 0.5  # W/(N m)^2: what a torque costs as heat in one motor.

    @property
    def effective_mass(self) -> float:
        """The mass that a driving force accelerates, kg: the robot's and the spinning wheels'."""
        return self.mass + 2.0 * self.wheel_inertia / self.wheel_radius**2

    @property
    def effective_yaw_inertia(self) -> float:
        """The inertia that a driving yaw torque accelerates, kg m^2: the robot's and the counter-rotating wheels'."""
        return self.yaw_inertia + 2.0 * self.wheel_inertia * (self.half_track / self.wheel_radius) ** 2


NOMINAL = RobotParameters()
"""The robot of `models/care_robot.sdf`."""
