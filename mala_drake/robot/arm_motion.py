"""The arm's joints sent from goal to goal, also while they are still on their way to another one."""

from __future__ import annotations

from dataclasses import dataclass

from mala_drake.messages import Message
from mala_drake.robot.arm_kinematics import Joints
from mala_drake.robot.joint_motion import MAX_ACCELERATION, JointMotion


@dataclass(frozen=True, slots=True)
class ArmMotion(Message):
    """First to rest, then to the goal.

    A single quintic that starts in the middle of another motion carries its acceleration on for a part of its own,
    perhaps much longer, duration, and so strays by a T^2 / 60 or more: a gripper about to end a short lift would dip by
    nearly a decimetre on its long way home, into what it has just risen from. Hence the arm brakes before it turns, on
    the way that it is on, and a way from rest is monotone in every joint.
    """

    braking: JointMotion = JointMotion()
    going: JointMotion = JointMotion()  # It starts when the braking is over.

    @property
    def end_time(self) -> float:
        """When the arm is at its goal, seconds."""
        return self.going.start_time + self.going.duration

    def at(self, time: float) -> tuple[Joints, Joints, Joints]:
        """Positions, rad, velocities, rad/s, and accelerations, rad/s^2, at `time`, seconds."""
        return (self.braking if time < self.going.start_time else self.going).at(time)

    def redirected(self, time: float, goal: Joints) -> ArmMotion:
        """The motion that leaves this one at `time`, without a jump in acceleration, for another goal."""
        now = self.braking if time < self.going.start_time else self.going
        braking = _to_rest(now, time)
        end = max(time, braking.start_time + braking.duration)
        return ArmMotion(braking, JointMotion(goal=braking.goal).redirected(end, goal))


def _to_rest(motion: JointMotion, time: float) -> JointMotion:
    """The motion that leaves `motion` at `time` and stops soon; `motion` itself when it is as good as over.

    With the end left free, the least jerk is that of the quartic which comes to rest at q + v T / 2 + a T^2 / 12. From
    v alone its peak deceleration is 3/2 v / T.
    """
    position, velocity, acceleration = motion.at(time)
    duration = 1.5 * max(abs(value) for value in velocity) / MAX_ACCELERATION
    if motion.start_time + motion.duration - time <= duration:
        return motion
    stop = tuple(
        q + duration * (0.5 * v + duration * a / 12.0) for q, v, a in zip(position, velocity, acceleration, strict=True)
    )
    return JointMotion(time, duration, position, velocity, acceleration, (stop[0], stop[1], stop[2]))
