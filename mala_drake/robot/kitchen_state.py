"""What has become of a meal: which dish is prepared, what has been done to its ingredients, how clean the kitchen is.

What has been done is kept by box, so that it is undone with a box that is lost: of another one in its place nothing is
known but that it has just been taken from the shelf.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mala_drake.messages import Atom, Message, Outcome
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.in_place_actions import InPlaceAction, Verb
from mala_drake.ward.items import Item

_TREATMENTS: Mapping[Verb, tuple[str, ...]] = {
    Verb.CHECK_INGREDIENTS: ("ingredients_checked", "ingredients_safe"),
    Verb.WASH: ("ingredients_washed",),
    Verb.CHOP: ("ingredients_chopped",),
    Verb.COOK: ("meal_cooked",),
    Verb.CHECK_COOKING_LEVEL: ("cooking_level_checked",),
    Verb.CHECK_PALATABILITY: ("meal_palatable",),
    Verb.ASSEMBLE: ("meal_assembled",),
}
"""What is done to the boxes in the gripper, and the predicates that are true of them afterwards."""

Boxes = tuple[str, str]
"""The box at each pad of the gripper, empty where there is none."""


@dataclass(frozen=True, slots=True)
class KitchenState(Message):
    """The state of a meal and of the kitchen.

    Attributes:
        dish: that has been chosen, empty for none yet.
        treated: (box, predicate) pairs: what is true of each box by now.
        workspace_clean: whether the preparation station is clean.
        hands_clean: whether the robot's gripper is.
        contamination_risk: whether something unwashed or raw has been handled since the last cleaning or cooking.
        served: the boxes that lie on the bedside table as a meal.
        at_bedside: whether the robot stands at a bedside, to hand a meal over.
    """

    dish: str = ""
    treated: tuple[tuple[str, str], ...] = ()
    workspace_clean: bool = False
    hands_clean: bool = False
    contamination_risk: bool = True  # Nobody knows what the workspace was used for.
    served: tuple[str, ...] = ()
    at_bedside: bool = False


def conclude_in_kitchen(
    state: KitchenState, done: InPlaceAction, outcome: Outcome, boxes: Boxes, *, served: Sequence[str] = ()
) -> KitchenState:
    """The state after an in-place action that has just ended.

    Args:
        state: before it.
        done: the action.
        outcome: how it ended: only a success has an effect, but whatever hangs at a pad has been touched.
        boxes: what really hangs in the gripper now.
        served: the boxes that it has put on a bedside table, all of those it was to put there; else empty.
    """
    if done.verb is Verb.COLLECT_INGREDIENT and boxes[done.slot]:
        return replace(state, hands_clean=False, contamination_risk=True)
    if done.verb is Verb.SERVE and served:
        return replace(state, served=tuple(served))
    if outcome is not Outcome.SUCCESS:
        return state
    if done.verb is Verb.CHOOSE:
        return replace(state, dish=done.dish)
    if done.verb is Verb.SANITIZE:
        return replace(state, workspace_clean=True, hands_clean=True, contamination_risk=False)
    if done.verb in _TREATMENTS and all(boxes):
        return _treated(state, done.verb, boxes)
    return state


def _treated(state: KitchenState, verb: Verb, boxes: Boxes) -> KitchenState:
    pairs = {*state.treated, *((box, predicate) for box in boxes for predicate in _TREATMENTS[verb])}
    state = replace(state, treated=tuple(sorted(pairs)))
    if verb is Verb.CHOP:
        raw = state.dish in DISHES and DISHES[state.dish].cooked
        return replace(state, workspace_clean=False, contamination_risk=state.contamination_risk or raw)
    if verb is Verb.COOK:
        return replace(state, contamination_risk=False)
    return state


def kitchen_atoms(
    state: KitchenState, boxes: Sequence[str], items: Mapping[str, Item], *, robot: str
) -> tuple[Atom, ...]:
    """What has been established about a meal.

    Args:
        state: of it.
        boxes: those in the gripper that the robot knows about.
        items: all boxes by name.
        robot: its name in the atoms.
    """
    held = [box for box in boxes if box]
    kinds = {items[box].kind for box in held}
    atoms: list[Atom] = [("collected_ingredient", robot, kind) for kind in kinds]
    if state.dish:
        atoms.append(("meal_to_prepare", robot, state.dish))
        needed = () if state.served else DISHES[state.dish].ingredients
        atoms += [("missing_ingredient", robot, kind) for kind in needed if kind not in kinds]
    meal = state.served or tuple(held)
    true_of_all = {
        predicate
        for predicates in _TREATMENTS.values()
        for predicate in predicates
        if len(meal) == 2 and all((box, predicate) in state.treated for box in meal)
    }
    atoms += [(predicate, robot) for predicate in true_of_all]
    if state.at_bedside and not state.served and {"meal_palatable", "meal_assembled"} <= true_of_all:
        atoms.append(("can_be_deliverable", robot))
    if state.workspace_clean:
        atoms.append(("workspace-clean",))
    if state.hands_clean:
        atoms.append(("robot-hands-clean", robot))
    if state.contamination_risk:
        atoms.append(("cross-contamination-risk",))
    return tuple(sorted(atoms))
