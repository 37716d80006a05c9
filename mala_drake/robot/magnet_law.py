"""The force of a magnet: a critically damped spring that carries the weight, with a limited reach and strength."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from casadi import copysign, cos, fabs, fmax, fmin, sin, sqrt

from mala_drake.robot.items import ITEM_INERTIA, ITEM_MASS
from mala_drake.robot.vectors import Vector, choose, combined, cross, dot, minus

GRAVITY = 9.81
"""m/s^2, as in the plant."""

Wrench = tuple[Vector, Vector]
"""A torque, N m, and a force, N, in the world frame."""

_NO_DISTANCE = 1e-9  # m, for which the spring's strength is no limit.


@dataclass(frozen=True, slots=True)
class Place:
    """Where a level box is to be: its centre, m, and yaw, rad, and how that place moves, m/s and rad/s."""

    position: Vector
    yaw: Any
    velocity: Vector = (0.0, 0.0, 0.0)
    yaw_rate: Any = 0.0


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
    frequency: float = 25.0  # omega, rad/s; explicit, stable for steps below (2 sqrt 2 - 2) / omega = 0.033 s.
    either_way_round: bool = True  # Whether half a turn about the vertical makes no difference.

    def wrench(self, box: Sequence[Any], place: Place) -> Wrench:
        """The wrench on a box at its centre, of floats or of CasADi symbols.

        Args:
            box: quaternion (w, x, y, z), position, angular velocity, translational velocity; 13 numbers, SI units.
            place: where it is to be.
        """
        deviation = minus(place.position, (box[4], box[5], box[6]))
        distance = sqrt(dot(deviation, deviation))
        within = distance <= self.reach  # Not when it is NaN.
        stiffness = fmin(ITEM_MASS * self.frequency**2, self.strength / fmax(distance, _NO_DISTANCE))
        closing = minus(place.velocity, (box[10], box[11], box[12]))
        force = combined(stiffness, deviation, 2.0 * ITEM_MASS * self.frequency, closing)
        turning = minus((0.0, 0.0, place.yaw_rate), (box[7], box[8], box[9]))
        rotation = self._rotation((box[0], box[1], box[2], box[3]), place.yaw)
        damping = 2.0 * ITEM_INERTIA * self.frequency
        torque = combined(ITEM_INERTIA * self.frequency**2, rotation, damping, turning)
        carrying = (force[0], force[1], force[2] + ITEM_MASS * GRAVITY)
        return _only_if(within, torque), _only_if(within, carrying)

    def _rotation(self, quaternion: tuple[Any, Any, Any, Any], yaw: Any) -> Vector:
        """The rotation, 2 vec(q_place q_box*), that takes a box to a level pose with that yaw, for small angles."""
        w, x, y, z = quaternion
        cosine, sine = cos(0.5 * yaw), sin(0.5 * yaw)
        alignment = cosine * w + sine * z
        if self.either_way_round:
            turned = cosine * z - sine * w
            half_a_turn = fabs(alignment) < fabs(turned)
            alignment = choose(half_a_turn, turned, alignment)
            cosine, sine = choose(half_a_turn, -sine, cosine), choose(half_a_turn, cosine, sine)
        sign = copysign(2.0 / sqrt(w * w + x * x + y * y + z * z), alignment)
        v_x, v_y, v_z = cross((x, y, z), (0.0, 0.0, sine))
        return sign * (v_x - cosine * x), sign * (v_y - cosine * y), sign * (v_z + w * sine - cosine * z)


def _only_if(condition: Any, vector: Vector) -> Vector:
    return choose(condition, vector[0], 0.0), choose(condition, vector[1], 0.0), choose(condition, vector[2], 0.0)
