"""Smooth point-to-point motion of the arm's joints, as a pure function of time."""

from __future__ import annotations

from dataclasses import dataclass

from mala_drake.messages import Message
from mala_drake.robot.arm_kinematics import STOWED, Joints

MAX_SPEED = 1.2
"""Of a joint that starts from rest, rad/s."""

MAX_ACCELERATION = 4.0
"""Of a joint that starts from rest, rad/s^2."""

# Peaks of the minimum-jerk profile 10 s^3 - 15 s^4 + 6 s^5, for a unit distance in unit time.
_PEAK_SPEED = 15.0 / 8.0
_PEAK_ACCELERATION = 10.0 / 3.0**0.5

_ZERO: Joints = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class JointMotion(Message):
    """All joints going from where they are to a goal, arriving together and at rest.

    Each joint follows the quintic with the given position, velocity and acceleration at `start_time` and none but a
    position at the end; from rest that is the minimum-jerk motion (Flash and Hogan, 1985).
    """

    start_time: float = 0.0  # Seconds.
    duration: float = 0.0  # Seconds; 0 stands at the goal.
    start: Joints = STOWED
    start_velocity: Joints = _ZERO
    start_acceleration: Joints = _ZERO
    goal: Joints = STOWED

    def at(self, time: float) -> tuple[Joints, Joints, Joints]:
        """Positions, rad, velocities, rad/s, and accelerations, rad/s^2, at `time`, seconds."""
        elapsed = time - self.start_time
        if elapsed >= self.duration:
            return self.goal, _ZERO, _ZERO
        joints = zip(self.start, self.start_velocity, self.start_acceleration, self.goal, strict=True)
        (q0, v0, a0), (q1, v1, a1), (q2, v2, a2) = (_quintic(*joint, self.duration, elapsed) for joint in joints)
        return (q0, q1, q2), (v0, v1, v2), (a0, a1, a2)

    def redirected(self, time: float, goal: Joints) -> JointMotion:
        """The motion that leaves this one at `time`, without a jump in acceleration, for another goal."""
        position, velocity, acceleration = self.at(time)
        distance = max(abs(end - now) for end, now in zip(goal, position, strict=True))
        duration = max(_PEAK_SPEED * distance / MAX_SPEED, (_PEAK_ACCELERATION * distance / MAX_ACCELERATION) ** 0.5)
        if velocity != _ZERO:
            # Time to lose the velocity it has, at the deceleration a motion from rest may have.
            fastest = max(abs(value) for value in velocity)
            duration = max(duration, _PEAK_ACCELERATION * fastest / MAX_ACCELERATION)
        return JointMotion(time, duration, position, velocity, acceleration, goal)


def _quintic(
    start: float, velocity: float, acceleration: float, goal: float, duration: float, elapsed: float
) -> tuple[float, float, float]:
    """Position, velocity and acceleration of the quintic that is at rest at `goal` after `duration` seconds."""
    s = elapsed / duration
    v, a, d = velocity * duration, acceleration * duration**2, goal - start
    c3 = 10.0 * d - 6.0 * v - 1.5 * a
    c4 = -15.0 * d + 8.0 * v + 1.5 * a
    c5 = 6.0 * d - 3.0 * v - 0.5 * a
    return (
        start + s * (v + s * (0.5 * a + s * (c3 + s * (c4 + s * c5)))),
        (v + s * (a + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / duration,
        (a + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / duration**2,
    )
