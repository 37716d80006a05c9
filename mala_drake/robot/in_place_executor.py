"""The in-place executor: what the robot does while it stands."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector, Context, LeafSystem, State

from mala_drake.clock import EXECUTE_OFFSET, TICK
from mala_drake.messages import Action, ActionReport, ArmCommand, MagnetCommand
from mala_drake.robot.in_place_execution import Execution, Senses, accept, advance
from mala_drake.robot.item_messages import HandedItem
from mala_drake.ward.items import Item, all_items
from mala_drake.ward.ward_map import Ward


class InPlaceExecutor(LeafSystem):
    """Collects, checks, puts down, delivers and recharges: takes the time it takes, and moves the arm.

    .. pydrake_system::

        name: InPlaceExecutor
        input_ports:
        - action
        - robot_state
        - handed_item
        - item_positions
        - arm_state
        - charge
        output_ports:
        - arm_target
        - magnet
        - in_place_report
        - charge_rates

    Each action runs for its time (see `mala_drake.ward.in_place_actions`), or a little longer when the arm has far to
    go, through the phases of its motion (see `mala_drake.robot.in_place_motions`), and has succeeded only if its
    physical effect is seen at the end. A newer action replaces a running one. While none is running the arm is stowed,
    and what the magnet holds stays held.

    `robot_state` is the estimate (x, y, yaw, v_x, v_y, omega_z); `item_positions` are the centres of the boxes in the
    order of the items; `arm_state` are the arm's three joint angles and their rates. `charge_rates` is what the
    action takes from the battery and what a charger puts into it, both in charge per second.
    """

    def __init__(self, ward: Ward, *, items: Sequence[Item] | None = None) -> None:
        """Constructs the executor for one ward; `items` are the boxes that there are, None for `all_items`."""
        super().__init__()
        self._ward = ward
        self._names = tuple(item.name for item in (all_items(ward) if items is None else items))
        self._action = self.DeclareAbstractInputPort("action", Value(Action()))
        self._robot_state = self.DeclareVectorInputPort("robot_state", 6)
        self._handed_item = self.DeclareAbstractInputPort("handed_item", Value(HandedItem()))
        self._item_positions = self.DeclareVectorInputPort("item_positions", 3 * len(self._names))
        self._arm_state = self.DeclareVectorInputPort("arm_state", 6)
        self._charge = self.DeclareVectorInputPort("charge", 1)
        self._execution = self.DeclareAbstractState(Value(Execution()))
        ticket = {self.abstract_state_ticket(self._execution)}
        for name, empty, calc in (
            ("arm_target", ArmCommand(), self._calc_arm_target),
            ("magnet", MagnetCommand(), self._calc_magnet),
            ("in_place_report", ActionReport(), self._calc_report),
        ):
            self.DeclareAbstractOutputPort(name, _allocator(empty), calc, prerequisites_of_calc=ticket)
        self.DeclareVectorOutputPort("charge_rates", 2, self._calc_charge_rates, prerequisites_of_calc=ticket)
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, EXECUTE_OFFSET, self._update)

    def _current(self, context: Context) -> Execution:
        execution: Execution = context.get_abstract_state(self._execution).get_value()
        return execution

    def _update(self, context: Context, state: State) -> None:
        execution, action = self._current(context), self._action.Eval(context)
        if action.sequence > execution.newest:
            following = accept(execution, action, self._sense(context), self._ward)
        elif execution.running:
            following = advance(execution, self._sense(context))
        else:
            return
        state.get_mutable_abstract_state(self._execution).set_value(following)

    def _sense(self, context: Context) -> Senses:
        x, y, yaw = self._robot_state.Eval(context).tolist()[:3]
        shoulder_yaw, shoulder_pitch, elbow_pitch = self._arm_state.Eval(context).tolist()[:3]
        values = self._item_positions.Eval(context).tolist()
        return Senses(
            time=context.get_time(),
            base=(x, y, yaw),
            joints=(shoulder_yaw, shoulder_pitch, elbow_pitch),
            positions={
                name: (values[3 * i], values[3 * i + 1], values[3 * i + 2]) for i, name in enumerate(self._names)
            },
            charge=float(self._charge.Eval(context)[0]),
            handed=self._handed_item.Eval(context),
        )

    def _calc_arm_target(self, context: Context, output: Value) -> None:
        output.set_value(self._current(context).arm)

    def _calc_magnet(self, context: Context, output: Value) -> None:
        output.set_value(MagnetCommand(self._current(context).held))

    def _calc_report(self, context: Context, output: Value) -> None:
        execution = self._current(context)
        output.set_value(
            ActionReport(
                execution.action.sequence,
                execution.outcome,
                steps=execution.steps,
                detail=execution.detail,
                shortfall=execution.shortfall,
            )
        )

    def _calc_charge_rates(self, context: Context, output: BasicVector) -> None:
        execution = self._current(context)
        output.SetFromVector([execution.draw, execution.charging])


def _allocator(empty: object) -> Callable[[], Value]:
    return lambda: Value(empty)
