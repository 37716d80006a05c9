"""The arm: gripper positions in, set points of the joint controllers out."""

from __future__ import annotations

from dataclasses import dataclass

from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector, Context, LeafSystem, State

from mala_drake.clock import CONTROL_OFFSET, TICK
from mala_drake.messages import ArmCommand, Message
from mala_drake.robot.arm_kinematics import STOWED, joints_for_gripper
from mala_drake.robot.arm_motion import ArmMotion


@dataclass(frozen=True, slots=True)
class _Moving(Message):
    command: ArmCommand = ArmCommand()
    motion: ArmMotion = ArmMotion()
    reachable: bool = True


class Arm(LeafSystem):
    """Moves the gripper where it is told, or stows it above the deck.

    .. pydrake_system::

        name: Arm
        input_ports:
        - arm_target
        output_ports:
        - desired_state
        - reachable
        - moving

    `arm_target` is an `ArmCommand`. `desired_state` are the positions, rad, and the velocities, rad/s, of the
    three joints for the `desired_state` port of the arm: a smooth joint motion towards the target, all joints arriving
    together, never faster than `mala_drake.robot.joint_motion.MAX_SPEED`; a target that comes in the middle of a motion
    makes it brake first. `reachable` is 1, or 0 when the
    target is out of reach or not finite: the arm then keeps the goal it had. `moving` is 1 until the set point has
    arrived.

    Commands are looked at once a tick, after the layer that gives them.
    """

    def __init__(self) -> None:
        super().__init__()
        self._arm_target = self.DeclareAbstractInputPort("arm_target", Value(ArmCommand()))
        self._moving = self.DeclareAbstractState(Value(_Moving()))
        state, time = self.abstract_state_ticket(self._moving), self.time_ticket()
        self.DeclareVectorOutputPort("desired_state", 6, self._calc_desired_state, {state, time})
        self.DeclareVectorOutputPort("reachable", 1, self._calc_reachable, {state})
        self.DeclareVectorOutputPort("moving", 1, self._calc_moving, {state, time})
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, CONTROL_OFFSET, self._accept)

    def _accept(self, context: Context, state: State) -> None:
        command = self._arm_target.Eval(context)
        moving = context.get_abstract_state(self._moving).get_value()
        if command == moving.command:
            return
        goal = STOWED if command.p_BG is None else joints_for_gripper(command.p_BG)
        if goal is None:
            accepted = _Moving(command, moving.motion, reachable=False)
        else:
            accepted = _Moving(command, moving.motion.redirected(context.get_time(), goal))
        state.get_mutable_abstract_state(self._moving).set_value(accepted)

    def _calc_desired_state(self, context: Context, output: BasicVector) -> None:
        motion = context.get_abstract_state(self._moving).get_value().motion
        position, velocity, _ = motion.at(context.get_time())
        output.SetFromVector([*position, *velocity])

    def _calc_reachable(self, context: Context, output: BasicVector) -> None:
        output.SetAtIndex(0, float(context.get_abstract_state(self._moving).get_value().reachable))

    def _calc_moving(self, context: Context, output: BasicVector) -> None:
        motion = context.get_abstract_state(self._moving).get_value().motion
        output.SetAtIndex(0, float(context.get_time() < motion.end_time))
