"""Motion of the gripper's pads in the world, and what a force on them does to the robot.

In plain scalars, floats or CasADi symbols, instead of Drake's multibody queries: the magnet needs a handful of vectors
at each step of the plant, and the compiled function costs a hundredth of evaluating the plant's kinematics through its
output ports.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from casadi import atan2, cos, sin

from mala_drake.robot.arm_kinematics import LINK_LENGTH, PAD_OFFSETS, SHOULDER
from mala_drake.robot.vectors import Vector, combined, cross, dot, minus, plus


@dataclass(frozen=True, slots=True)
class GripperMotion:
    """The arm in the world at one instant. All vectors are expressed in the world frame, SI units."""

    base: Vector  # Origin of the base.
    base_omega: Vector
    base_velocity: Vector  # Of the base's origin.
    axes: tuple[Vector, Vector, Vector]  # Unit vectors, of shoulder yaw, shoulder pitch and elbow pitch.
    centers: tuple[Vector, Vector, Vector]  # A point on each axis.
    rates: Vector  # Of the joints, rad/s.
    gripper: Vector
    bar: Vector  # Unit vector along the magnet bar, from pad 1 to pad 0.

    @property
    def yaw(self) -> Any:
        """Heading of the gripper seen from above, rad."""
        return atan2(-self.bar[0], self.bar[1])

    @property
    def yaw_rate(self) -> Any:
        """How fast the gripper turns about the vertical, rad/s."""
        return self.base_omega[2] + self.rates[0]

    def pad_position(self, pad: int) -> Vector:
        """The middle of roller `pad`, m."""
        return combined(1.0, self.gripper, PAD_OFFSETS[pad], self.bar)

    def velocity_at(self, point: Vector) -> Vector:
        """The velocity of the gripper's material at `point`, m/s."""
        velocity = plus(self.base_velocity, cross(self.base_omega, minus(point, self.base)))
        for axis, center, rate in zip(self.axes, self.centers, self.rates, strict=True):
            velocity = combined(1.0, velocity, rate, cross(axis, minus(point, center)))
        return velocity

    def generalized_force(self, point: Vector, torque: Vector, force: Vector) -> tuple[list[Any], list[Any]]:
        """What a wrench on the gripper does to the robot, by the transpose of the gripper's Jacobian.

        Args:
            point: of the gripper, at which it acts.
            torque: N m.
            force: N.

        Returns:
            The six generalized forces of the floating base, torque then force, and the three of the arm's joints.
        """
        base = [*plus(torque, cross(minus(point, self.base), force)), *force]
        joints = [
            dot(axis, plus(torque, cross(minus(point, center), force)))
            for axis, center in zip(self.axes, self.centers, strict=True)
        ]
        return base, joints


def gripper_motion(base: Sequence[Any], joint_positions: Sequence[Any], joint_rates: Sequence[Any]) -> GripperMotion:
    """The arm in the world, from the state of base and arm.

    Args:
        base: quaternion (w, x, y, z), position, angular velocity, translational velocity; 13 numbers.
        joint_positions: of the arm, rad.
        joint_rates: of the arm, rad/s.
    """
    w, x, y, z, p_x, p_y, p_z, *velocities = base
    # The discrete plant lets the quaternion's norm drift while the robot turns; only its direction has a meaning.
    k = 2.0 / (w * w + x * x + y * y + z * z)
    forward = (1.0 - k * (y * y + z * z), k * (x * y + w * z), k * (x * z - w * y))
    left = (k * (x * y - w * z), 1.0 - k * (x * x + z * z), k * (y * z + w * x))
    up = cross(forward, left)
    yaw, pitch, bend = joint_positions
    outward = combined(cos(yaw), forward, sin(yaw), left)
    bar = combined(-sin(yaw), forward, cos(yaw), left)
    position = (p_x, p_y, p_z)
    shoulder = plus(
        plus(position, combined(SHOULDER[0], forward, SHOULDER[1], left)), combined(SHOULDER[2], up, 0.0, up)
    )
    upper_arm = combined(LINK_LENGTH * cos(pitch), outward, LINK_LENGTH * sin(pitch), up)
    forearm = combined(LINK_LENGTH * cos(pitch + bend), outward, LINK_LENGTH * sin(pitch + bend), up)
    elbow = plus(shoulder, upper_arm)
    lifting = (-bar[0], -bar[1], -bar[2])
    return GripperMotion(
        base=position,
        base_omega=(velocities[0], velocities[1], velocities[2]),
        base_velocity=(velocities[3], velocities[4], velocities[5]),
        axes=(up, lifting, lifting),
        centers=(shoulder, shoulder, elbow),
        rates=(joint_rates[0], joint_rates[1], joint_rates[2]),
        gripper=plus(elbow, forearm),
        bar=bar,
    )
