"""What really happens to the boxes, and what the robot gets to know of it.

The truth (which boxes the dispensers still keep, which one was really handed over, what hangs in the gripper) is kept
apart from what the robot has established: it believes the label it asked for until a check has read the box.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mala_drake.messages import Action, ActionKind, MagnetCommand, Message, Outcome, Task
from mala_drake.robot.arm_kinematics import Point
from mala_drake.robot.item_messages import HandedItem
from mala_drake.robot.kitchen_state import Boxes, KitchenState, conclude_in_kitchen
from mala_drake.ward.in_place_actions import (
    COLLECTING,
    DELIVERING,
    InPlaceAction,
    Verb,
    in_place_action,
    ingredient_slot,
)
from mala_drake.ward.items import Item

HOLDING_DISTANCE = 0.05
"""Metres from its place at a pad within which a box counts as held."""

_TAKEN_BACK = 0.05  # Metres from its place on the shelf within which a dispenser gets hold of a loose box again.


@dataclass(frozen=True, slots=True)
class Carried(Message):
    """One of the two things the robot can carry.

    Attributes:
        item: the box that really hangs at the pad, empty when none does.
        label: the kind that the robot takes it for; empty until the collect action has ended.
        verdict: "correct" or "wrong" once a check has established it.
    """

    item: str = ""
    label: str = ""
    verdict: str = ""


@dataclass(frozen=True, slots=True)
class WorldState(Message):
    """The truth about the boxes and what has been established. All tuples over slots have two entries."""

    stock: tuple[str, ...] = ()  # Boxes that dispensers keep, in the order of the ward.
    carried: tuple[Carried, Carried] = (Carried(), Carried())
    handed: HandedItem = HandedItem()
    hand_overs: int = 0  # In this task.
    mistakes: tuple[str, ...] = ()  # Kinds still to be handed over whatever is asked for.
    action: Action = Action()  # The newest one.
    taken_along: Boxes = ("", "")  # The boxes carried when it began.
    concluded: int = 0  # Sequence of the last in-place action whose effects are established.
    delivered: bool = False
    kitchen: KitchenState = KitchenState()
    task: Task = Task()

    @property
    def boxes(self) -> Boxes:
        """What really hangs at each pad."""
        return self.carried[0].item, self.carried[1].item


def begin_task(state: WorldState, task: Task, mistakes: tuple[str, ...]) -> WorldState:
    """A new task finds stock and gripper as they are, but nothing delivered and all `mistakes` still to be made."""
    kitchen = KitchenState(at_bedside=state.kitchen.at_bedside)
    return replace(state, task=task, delivered=False, hand_overs=0, mistakes=mistakes, kitchen=kitchen)


def choose_item(
    state: WorldState,
    items: Sequence[Item],
    kind: str,
    place: str,
    generator: np.random.Generator,
    *,
    wrong_probability: float,
) -> Item | None:
    """The box that the dispenser at `place` really hands over when asked for `kind`; None when it is out of stock.

    It is the first of the mistakes still to be made that this dispenser can make; else, with `wrong_probability`, a
    box of another kind if there is one; else the right one. Ingredients stand on an open shelf: nobody hands them over,
    so they are what they look like.
    """
    here: dict[str, Item] = {}
    for item in items:
        if item.place == place and item.name in state.stock:
            here.setdefault(item.kind, item)
    if kind not in here or ingredient_slot(kind) is not None:
        return here.get(kind)
    others = [item for item in here.values() if item.kind != kind]
    mistaken = generator.random() < wrong_probability
    for mistake in state.mistakes:
        if mistake in here:
            return here[mistake]
    if mistaken and others:
        return others[int(generator.integers(len(others)))]
    return here[kind]


def begin_action(state: WorldState, action: Action, handed: Item | None) -> WorldState:
    """A new action; `handed` is the box handed over when it is a collect action that found one."""
    state = replace(state, action=action, taken_along=state.boxes)
    asked = read_action(action)
    if asked is None or asked.verb not in COLLECTING:
        return state
    if handed is None:
        return replace(state, handed=HandedItem(action.sequence), hand_overs=state.hand_overs + 1)
    mistakes = list(state.mistakes)
    if handed.kind in mistakes:
        mistakes.remove(handed.kind)
    return replace(
        state,
        handed=HandedItem(action.sequence, handed.name, handed.shelf_pose),
        hand_overs=state.hand_overs + 1,
        mistakes=tuple(mistakes),
    )


def follow_magnet(
    state: WorldState, magnet: MagnetCommand, positions: Mapping[str, Point], hanging: Sequence[Point]
) -> WorldState:
    """Boxes that the magnet wants leave their dispensers; a pad has what is wanted at it and really hangs there."""
    wanted = {pad: item for item, pad in magnet.held}
    stock = tuple(item for item in state.stock if item not in wanted.values())
    first, second = (
        _carried_at(carried, wanted.get(pad, ""), positions, hanging[pad]) for pad, carried in enumerate(state.carried)
    )
    if stock == state.stock and (first, second) == state.carried:
        return state
    return replace(state, stock=stock, carried=(first, second))


def _carried_at(carried: Carried, wanted: str, positions: Mapping[str, Point], hanging: Point) -> Carried:
    if not wanted or not math.dist(positions[wanted], hanging) <= HOLDING_DISTANCE:  # Also when it is NaN.
        return Carried()
    return carried if wanted == carried.item else Carried(wanted)


def conclude(
    state: WorldState,
    outcome: Outcome,
    items: Mapping[str, Item],
    requested: Sequence[str],
    *,
    on_table: Sequence[bool],
) -> WorldState:
    """Establishes the effects of the action that has just ended, as far as they are really there.

    Args:
        state: the world so far.
        outcome: how `state.action` ended.
        items: all boxes by name.
        requested: the kind asked for in each slot.
        on_table: whether each box in `state.taken_along` rests on the bedside table.
    """
    done = read_action(state.action)
    state = replace(state, concluded=state.action.sequence)
    if done is None:
        return state
    served = state.taken_along if done.verb in DELIVERING and on_table and all(on_table) else ()
    kitchen = conclude_in_kitchen(state.kitchen, done, outcome, state.boxes, served=served)
    state = replace(state, kitchen=kitchen)
    if done.verb in DELIVERING:
        return replace(state, delivered=state.delivered or bool(served))
    carried = state.carried[done.slot] if done.slot >= 0 else Carried()
    if not carried.item:
        return state
    if done.verb in COLLECTING:
        carried = replace(carried, label=carried.label or done.kind)
    elif done.verb is Verb.CHECK and outcome is Outcome.SUCCESS:
        kind = items[carried.item].kind
        found = "correct" if kind == requested[done.slot] else "wrong"
        carried = replace(carried, label=kind, verdict=found if found == done.verdict else carried.verdict)
    return replace(state, carried=_with_entry(state.carried, done.slot, carried))


def take_back(
    state: WorldState, items: Sequence[Item], magnet: MagnetCommand, positions: Mapping[str, Point]
) -> WorldState:
    """Loose boxes still in their places on the shelf are kept by their dispensers again."""
    wanted = {item for item, _ in magnet.held}

    def is_kept(item: Item) -> bool:
        pose = item.shelf_pose
        in_place = math.dist(positions[item.name], (pose.x, pose.y, pose.z)) <= _TAKEN_BACK
        return item.name in state.stock or (item.name not in wanted and in_place)

    stock = tuple(item.name for item in items if is_kept(item))
    return state if stock == state.stock else replace(state, stock=stock)


def read_action(action: Action) -> InPlaceAction | None:
    """The in-place action that `action` is, None for a leg or an unknown name."""
    return in_place_action(action.name, action.arguments) if action.kind is ActionKind.IN_PLACE else None


def _with_entry(pair: tuple, slot: int, entry: object) -> tuple:
    return (entry, pair[1]) if slot == 0 else (pair[0], entry)
