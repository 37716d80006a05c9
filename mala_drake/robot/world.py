"""The world around the robot: dispensers, boxes and bedside tables, as they really are."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from pydrake.common.value import Value
from pydrake.systems.framework import Context, LeafSystem, State

from mala_drake.clock import TICK, WORLD_OFFSET
from mala_drake.errors import BadInput
from mala_drake.messages import Action, ActionReport, MagnetCommand, Outcome, Task, WorldFacts
from mala_drake.randomness import keyed_generator
from mala_drake.robot.arm_kinematics import Point
from mala_drake.robot.established_atoms import established_atoms
from mala_drake.robot.gripper_geometry import PlanarPose, hanging_positions
from mala_drake.robot.item_messages import ClampedItems, HandedItem
from mala_drake.robot.plant_state import PLANT_STATE_SIZE, X, Y, yaw_of
from mala_drake.robot.world_state import (
    WorldState,
    begin_action,
    begin_task,
    choose_item,
    conclude,
    follow_magnet,
    read_action,
    take_back,
)
from mala_drake.ward.in_place_actions import COLLECTING, SLOTS
from mala_drake.ward.items import ITEM_HALF_HEIGHT, KINDS, Item, all_items
from mala_drake.ward.shapes import ShapeDistances
from mala_drake.ward.ward_map import Ward

REQUESTED: Mapping[str, str] = {"medication": "med_antibiotic", "supplement": "supp_vitamin_d"}
"""What the patient of the hospital case is to get."""

_AT_BEDSIDE = 1.0  # Metres from a bedside's standing point; whether the arm reaches its table, it finds out itself.
_RESTING_SLACK = 0.03  # Metres that the centre of a box on a table may be off its height: it may have tipped over.


class World(LeafSystem):
    """Keeps what really happens to the boxes apart from what the robot knows about it.

    .. pydrake_system::

        name: World
        input_ports:
        - task
        - action
        - magnet
        - in_place_report
        - item_positions
        - plant_state
        - arm_state
        output_ports:
        - world_facts
        - handed_item
        - clamped

    A collect action makes the dispenser of the place hand over a box: the one asked for, or with a small probability
    another one. Ingredients stand on open shelves and are what they look like. A box stays clamped until the gripper's
    magnet wants it. Whether a box hangs in the gripper or rests on a bedside table is judged by where it really is,
    from the plant: `item_positions` are the centres of the boxes, x, y and z each, in their order; `plant_state` and
    `arm_state` are the state ports of the robot's base and arm. Effects are established at the first tick that sees the
    report of their action; place names in the atoms are spelled as on the map. What is known of meals is established
    where there are ingredients.

    The choices of an episode depend on the seed, the number of the episode in `task` and the number of the hand-over.
    """

    def __init__(
        self,
        ward: Ward,
        *,
        items: Sequence[Item] | None = None,
        requested: Mapping[str, str] | None = None,
        wrong_item_probability: float = 0.0,
        wrong_items: Sequence[str] = (),
        seed: int = 0,
        robot: str = "robot1",
    ) -> None:
        """Constructs the world with all boxes in their dispensers.

        Args:
            ward: the map.
            items: the boxes that there are; None for `all_items`.
            requested: the kind that is right, for "medication" and "supplement"; None for `REQUESTED`.
            wrong_item_probability: of each hand-over, in [0, 1].
            wrong_items: kinds that are handed over first in each task, whatever is asked for: each at the first
                hand-over of a dispenser that keeps it.
            seed: of the run.
            robot: its name in the atoms.

        Raises:
            BadInput: naming the argument that is not valid.
        """
        super().__init__()
        self._requested = _requested_kinds(REQUESTED if requested is None else requested)
        self._mistakes = tuple(wrong_items)
        if not 0.0 <= wrong_item_probability <= 1.0:
            raise BadInput("wrong_item_probability", repr(wrong_item_probability), "a number in [0, 1]")
        self._wrong_probability = wrong_item_probability
        keyed_generator(seed, 0, "world")  # Refuses a bad seed now rather than in the simulation.
        self._seed = seed
        self._robot = robot
        self._items = all_items(ward) if items is None else tuple(items)
        kinds = {kind: None for kept in KINDS.values() for kind in kept}
        for i, kind in enumerate(self._mistakes):
            if kind not in kinds:
                raise BadInput(f"wrong_items[{i}]", repr(kind), "one of " + ", ".join(kinds))
        self._item_by_name = {item.name: item for item in self._items}
        self._tables = {
            name: piece for name, piece in ward.furniture_of.items() if ward.place[name].category == "bedside"
        }
        self._bedsides = [(place.x, place.y) for place in ward.places if place.category == "bedside"]
        # One message for each stock that there ever was: the magnet works on it at the plant's rate, by identity.
        self._clamped: dict[tuple[str, ...], ClampedItems] = {}
        self._declare_ports()

    def _declare_ports(self) -> None:
        self._task = self.DeclareAbstractInputPort("task", Value(Task()))
        self._action = self.DeclareAbstractInputPort("action", Value(Action()))
        self._magnet = self.DeclareAbstractInputPort("magnet", Value(MagnetCommand()))
        self._report = self.DeclareAbstractInputPort("in_place_report", Value(ActionReport()))
        self._positions = self.DeclareVectorInputPort("item_positions", 3 * len(self._items))
        self._plant_state = self.DeclareVectorInputPort("plant_state", PLANT_STATE_SIZE)
        self._arm_state = self.DeclareVectorInputPort("arm_state", 6)
        full = WorldState(stock=tuple(item.name for item in self._items))
        self._state = self.DeclareAbstractState(Value(full))
        ticket = {self.abstract_state_ticket(self._state)}
        for name, empty, calc in (
            ("world_facts", WorldFacts(), self._calc_world_facts),
            ("handed_item", HandedItem(), self._calc_handed_item),
            ("clamped", ClampedItems(), self._calc_clamped),
        ):
            self.DeclareAbstractOutputPort(name, _allocator(empty), calc, prerequisites_of_calc=ticket)
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, WORLD_OFFSET, self._update)

    def _current(self, context: Context) -> WorldState:
        state: WorldState = context.get_abstract_state(self._state).get_value()
        return state

    def _calc_world_facts(self, context: Context, output: Value) -> None:
        state = self._current(context)
        output.set_value(WorldFacts(established_atoms(state, self._item_by_name, robot=self._robot), state.concluded))

    def _calc_handed_item(self, context: Context, output: Value) -> None:
        output.set_value(self._current(context).handed)

    def _calc_clamped(self, context: Context, output: Value) -> None:
        stock = self._current(context).stock
        if stock not in self._clamped:
            self._clamped[stock] = ClampedItems(tuple((name, self._item_by_name[name].shelf_pose) for name in stock))
        output.set_value(self._clamped[stock])

    def _update(self, context: Context, state: State) -> None:
        before = self._current(context)
        task, action = self._task.Eval(context), self._action.Eval(context)
        magnet, report = self._magnet.Eval(context), self._report.Eval(context)
        world = before
        if task.sequence > world.task.sequence:
            world = begin_task(world, task, self._mistakes)
        base = self._base_pose(context)
        if magnet.held or any(world.boxes):
            world = follow_magnet(world, magnet, self._item_positions(context), self._hanging(context, base))
        world = self._follow_base(world, base)
        outcome = _outcome(world, action, report)
        if outcome is not Outcome.RUNNING:
            positions = self._item_positions(context)
            on_table = [self._is_on_table(positions, item, world.action.place) for item in world.taken_along]
            world = conclude(world, outcome, self._item_by_name, self._requested, on_table=on_table)
            world = take_back(world, self._items, magnet, positions)
        if action.sequence > world.action.sequence:
            world = begin_action(world, action, self._hand_over(world, action))
        if world is not before:
            state.get_mutable_abstract_state(self._state).set_value(world)

    def _item_positions(self, context: Context) -> dict[str, Point]:
        values = self._positions.Eval(context).tolist()
        return {item.name: (values[3 * i], values[3 * i + 1], values[3 * i + 2]) for i, item in enumerate(self._items)}

    def _base_pose(self, context: Context) -> PlanarPose:
        plant_state = self._plant_state.Eval(context).tolist()
        return plant_state[X], plant_state[Y], yaw_of(plant_state)

    def _hanging(self, context: Context, base: PlanarPose) -> tuple[Point, ...]:
        yaw, shoulder, elbow = self._arm_state.Eval(context).tolist()[:3]
        return hanging_positions(base, (yaw, shoulder, elbow))

    def _follow_base(self, world: WorldState, base: PlanarPose) -> WorldState:
        at_bedside = any(math.dist(base[:2], place) <= _AT_BEDSIDE for place in self._bedsides)
        if at_bedside == world.kitchen.at_bedside:
            return world
        return replace(world, kitchen=replace(world.kitchen, at_bedside=at_bedside))

    def _hand_over(self, world: WorldState, action: Action) -> Item | None:
        asked = read_action(action)
        if asked is None or asked.verb not in COLLECTING:
            return None
        generator = keyed_generator(self._seed, world.task.episode, f"world/{world.hand_overs}")
        return choose_item(
            world, self._items, asked.kind, action.place, generator, wrong_probability=self._wrong_probability
        )

    def _is_on_table(self, positions: Mapping[str, Point], item: str, place: str) -> bool:
        table = self._tables.get(place)
        if table is None or not item:
            return False
        x, y, z = positions[item]
        inside = ShapeDistances([table.shape])((x, y))[0] <= 0.0
        return bool(inside) and abs(z - table.height - ITEM_HALF_HEIGHT) <= _RESTING_SLACK


def _outcome(world: WorldState, newest: Action, report: ActionReport) -> Outcome:
    """How the world's current in-place action has just ended, RUNNING if it has not (or had not begun)."""
    current = world.action.sequence
    if world.concluded >= current or read_action(world.action) is None:
        return Outcome.RUNNING
    if report.sequence == current and report.finished:
        return report.outcome
    return Outcome.CANCELLED if newest.sequence > current else Outcome.RUNNING


def _allocator(empty: object) -> Callable[[], Value]:
    return lambda: Value(empty)


def _requested_kinds(requested: Mapping[str, str]) -> tuple[str, ...]:
    """The requested kind of each slot."""
    for key in requested:
        if key not in SLOTS:
            raise BadInput(f"requested.{key}", "unknown key", "one of " + ", ".join(SLOTS))
    for slot, kinds in zip(SLOTS, (KINDS["pharmacy"], KINDS["supply"]), strict=True):
        if requested.get(slot) not in kinds:
            raise BadInput(f"requested.{slot}", repr(requested.get(slot)), "one of " + ", ".join(kinds))
    return tuple(requested[slot] for slot in SLOTS)
