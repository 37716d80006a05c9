"""The actions done in place: what each is for, how long it takes and what it costs.

One table for the planner's predictions and for the executor's motions. Names are those of the planning domains.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache
from types import MappingProxyType

from mala_drake.ward.dishes import DISHES

SLOTS = ("medication", "supplement")
"""What the robot can carry on a medication round: one box of each, at the gripper pad of the same index."""


class Verb(Enum):
    """What is done."""

    COLLECT = "collect"
    CHECK = "check"
    PUT_DOWN = "put_down"
    DELIVER = "deliver"
    RECHARGE = "recharge"
    CHOOSE = "choose"
    COLLECT_INGREDIENT = "collect_ingredient"
    CHECK_INGREDIENTS = "check_ingredients"
    SANITIZE = "sanitize"
    WASH = "wash"
    CHOP = "chop"
    COOK = "cook"
    CHECK_COOKING_LEVEL = "check_cooking_level"
    CHECK_PALATABILITY = "check_palatability"
    ASSEMBLE = "assemble"
    SERVE = "serve"


VERBS: Mapping[str, tuple[Verb, ...]] = MappingProxyType(
    {
        "medication": (Verb.COLLECT, Verb.CHECK, Verb.PUT_DOWN, Verb.DELIVER, Verb.RECHARGE),
        "meal": (
            Verb.CHOOSE,
            Verb.COLLECT_INGREDIENT,
            Verb.CHECK_INGREDIENTS,
            Verb.SANITIZE,
            Verb.WASH,
            Verb.CHOP,
            Verb.COOK,
            Verb.CHECK_COOKING_LEVEL,
            Verb.CHECK_PALATABILITY,
            Verb.ASSEMBLE,
            Verb.SERVE,
            Verb.RECHARGE,
        ),
    }
)
"""What is done in each task."""

COLLECTING = frozenset({Verb.COLLECT, Verb.COLLECT_INGREDIENT})
"""Verbs that take a box from where it is kept."""

DELIVERING = frozenset({Verb.DELIVER, Verb.SERVE})
"""Verbs that put the gripper's boxes on a bedside table."""

SECONDS = {
    Verb.COLLECT: 5.0,
    Verb.CHECK: 2.0,
    Verb.PUT_DOWN: 3.0,
    Verb.DELIVER: 20.0,
    Verb.RECHARGE: 30.0,
    Verb.CHOOSE: 0.5,
    Verb.COLLECT_INGREDIENT: 5.0,
    Verb.CHECK_INGREDIENTS: 4.0,
    Verb.SANITIZE: 5.0,
    Verb.WASH: 6.0,
    Verb.CHOP: 8.0,
    Verb.COOK: 12.0,
    Verb.CHECK_COOKING_LEVEL: 4.0,
    Verb.CHECK_PALATABILITY: 4.0,
    Verb.ASSEMBLE: 5.0,  # Of a plain dish; see `Dish.assembling`.
    Verb.SERVE: 10.0,
}
"""Duration of each, seconds."""

CHARGE = {
    Verb.COLLECT: 0.05,
    Verb.CHECK: 0.02,
    Verb.PUT_DOWN: 0.05,
    Verb.DELIVER: 0.02,
    Verb.RECHARGE: 0.0,
    Verb.CHOOSE: 0.0,
    Verb.COLLECT_INGREDIENT: 0.02,
    Verb.CHECK_INGREDIENTS: 0.01,
    Verb.SANITIZE: 0.02,
    Verb.WASH: 0.02,
    Verb.CHOP: 0.03,
    Verb.COOK: 0.50,
    Verb.CHECK_COOKING_LEVEL: 0.01,
    Verb.CHECK_PALATABILITY: 0.01,
    Verb.ASSEMBLE: 0.02,
    Verb.SERVE: 0.01,
}
"""State of charge that each uses."""


@dataclass(frozen=True, slots=True)
class InPlaceAction:
    """An action of a domain as the executor understands it.

    Attributes:
        verb: what is done.
        slot: the gripper pad of what it is done with; -1 for both or none.
        kind: of the item that a collect action asks for, else empty.
        verdict: "correct" or "wrong", what a check of a medicine or supplement is to establish, else empty.
        dish: that is chosen, prepared or served, where the action names one, else empty.
    """

    verb: Verb
    slot: int = -1
    kind: str = ""
    verdict: str = ""
    dish: str = ""

    @property
    def seconds(self) -> float:
        """Its duration."""
        if self.verb is Verb.ASSEMBLE and self.dish:
            return DISHES[self.dish].assembling
        return SECONDS[self.verb]

    @property
    def charge(self) -> float:
        """The state of charge it uses."""
        return CHARGE[self.verb]


_FIXED = {
    "put_down_medicine": InPlaceAction(Verb.PUT_DOWN, slot=0),
    "put_down_supplement": InPlaceAction(Verb.PUT_DOWN, slot=1),
    "recharge": InPlaceAction(Verb.RECHARGE),
} | {
    f"check_{name}_{verdict}": InPlaceAction(Verb.CHECK, slot=slot, verdict=verdict)
    for slot, name in enumerate(SLOTS)
    for verdict in ("correct", "wrong")
}

_COLLECT = {"collect_med_": 0, "collect_supp_": 1}

_WITH_DISH = {
    "check_ingredients": Verb.CHECK_INGREDIENTS,
    "sanitize_workspace": Verb.SANITIZE,
    "wash_ingredients": Verb.WASH,
    "chop_ingredients": Verb.CHOP,
    "cook_meal": Verb.COOK,
    "check_cooking_level": Verb.CHECK_COOKING_LEVEL,
    "check_palatability": Verb.CHECK_PALATABILITY,
    "assemble": Verb.ASSEMBLE,
}

_INGREDIENT_SLOTS = {kind: slot for dish in DISHES.values() for slot, kind in enumerate(dish.ingredients)}

_DELIVER = ("deliver_on_bedside_table_left", "deliver_on_bedside_table_right")


def ingredient_slot(kind: str) -> int | None:
    """The gripper pad of an ingredient, the same in every dish; None for what is no ingredient."""
    return _INGREDIENT_SLOTS.get(kind)


def in_place_action(name: str, arguments: Sequence[str] = ()) -> InPlaceAction | None:
    """The in-place action called `name`, or None when there is none of that name.

    Args:
        name: of the action in its domain.
        arguments: of the action; they tell which ingredient is collected, and a meal from a delivery of medicine.
    """
    return _read(name, tuple(arguments))


@cache  # Ground actions are few, and many systems read the one under way at every tick.
def _read(name: str, arguments: tuple[str, ...]) -> InPlaceAction | None:
    dish = next((each for each in arguments if each in DISHES), "")
    if name in _DELIVER:
        return InPlaceAction(Verb.SERVE, dish=dish) if dish else InPlaceAction(Verb.DELIVER)
    if name in _WITH_DISH:
        return InPlaceAction(_WITH_DISH[name], dish=dish)
    if name == "collect_ingredient":
        kind = next((each for each in arguments if ingredient_slot(each) is not None), None)
        slot = None if kind is None else ingredient_slot(kind)
        return None if kind is None or slot is None else InPlaceAction(Verb.COLLECT_INGREDIENT, slot=slot, kind=kind)
    if name.startswith("choose_") and name.removeprefix("choose_") in DISHES:
        return InPlaceAction(Verb.CHOOSE, dish=name.removeprefix("choose_"))
    for prefix, slot in _COLLECT.items():
        if name.startswith(prefix) and len(name) > len(prefix):
            return InPlaceAction(Verb.COLLECT, slot=slot, kind=name.removeprefix("collect_"))
    return _FIXED.get(name)
