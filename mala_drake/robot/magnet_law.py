"""The force of a magnet: a critically damped spring that carries the weight, with a limited reach and strength."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from mala_drake.robot.items import ITEM_INERTIA, ITEM_MASS
from mala_drake.robot.vectors import Vector, combined, cross, dot, minus

GRAVITY = 9.81
"""m/s^2, as in the plant."""

Wrench = tuple[Vector, Vector]
"""A torque, N m, and a force, N, in the world frame."""

_NOTHING: Wrench = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@dataclass(frozen=True, slots=True)
class Place:
    """Where a level box is to be: its centre, m, and yaw, rad, and how that place moves, m/s and rad/s."""

    position: Vector
    yaw: float
    velocity: Vector = (0.0, 0.0, 0.0)
    yaw_rate: float = 0.0


@dataclass(frozen=True, slots=True)
class MagnetLaw:
    """Pulls a box, level and upright, to its place.

    With e the deviation from the place, in translation and in rotation, force and torque are m (omega^2 e + 2 omega e')
    and I (omega^2 e + 2 omega e'), plus the weight. The spring's pull is bounded by `strength`; a box farther from its
    place than `reach` is not felt at all. The law has no memory: a box that is torn away by more than `reach` is lost,
    one that comes back within it is caught again.
    """

    reach: float = 0.03  # m.
    strength: float = 15.0  # N.
    frequency: float = 25.0  # omega, rad/s; explicit at the plant's step of 0.01 s that is well within stability.
    either_way_round: bool = True  # Whether half a turn about the vertical makes no difference.

    def wrench(self, box: Sequence[float], place: Place) -> Wrench:
        """The wrench on a box at its centre.

        Args:
            box: quaternion (w, x, y, z), position, angular velocity, translational velocity; 13 numbers, SI units.
            place: where it is to be.
        """
        deviation = minus(place.position, (box[4], box[5], box[6]))
        distance = math.sqrt(dot(deviation, deviation))
        if not distance <= self.reach:  # Also when it is NaN.
            return _NOTHING
        stiffness = ITEM_MASS * self.frequency**2
        if distance * stiffness > self.strength:
            stiffness = self.strength / distance
        closing = minus(place.velocity, (box[10], box[11], box[12]))
        force = combined(stiffness, deviation, 2.0 * ITEM_MASS * self.frequency, closing)
        turning = minus((0.0, 0.0, place.yaw_rate), (box[7], box[8], box[9]))
        rotation = self._rotation((box[0], box[1], box[2], box[3]), place.yaw)
        damping = 2.0 * ITEM_INERTIA * self.frequency
        torque = combined(ITEM_INERTIA * self.frequency**2, rotation, damping, turning)
        return torque, (force[0], force[1], force[2] + ITEM_MASS * GRAVITY)

    def _rotation(self, quaternion: tuple[float, float, float, float], yaw: float) -> Vector:
        """The rotation, 2 vec(q_place q_box*), that takes a box to a level pose with that yaw, for small angles."""
        w, x, y, z = quaternion
        cos, sin = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
        if self.either_way_round and abs(cos * w + sin * z) < abs(cos * z - sin * w):
            cos, sin = -sin, cos
        sign = math.copysign(2.0 / math.sqrt(w * w + x * x + y * y + z * z), cos * w + sin * z)
        v_x, v_y, v_z = cross((x, y, z), (0.0, 0.0, sin))
        return sign * (v_x - cos * x), sign * (v_y - cos * y), sign * (v_z + w * sin - cos * z)
