"""The actions done in place: what each is for, how long it takes and what it costs.

One table for the planner's predictions and for the executor's motions. Names are those of the planning domain.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

SLOTS = ("medication", "supplement")
"""What the robot can carry: one box of each, at the gripper pad of the same index."""


class Verb(Enum):
    """What is done."""

    COLLECT = "collect"
    CHECK = "check"
    PUT_DOWN = "put_down"
    DELIVER = "deliver"
    RECHARGE = "recharge"


SECONDS = {Verb.COLLECT: 5.0, Verb.CHECK: 2.0, Verb.PUT_DOWN: 3.0, Verb.DELIVER: 20.0, Verb.RECHARGE: 30.0}
"""Duration of each, seconds."""

CHARGE = {Verb.COLLECT: 0.05, Verb.CHECK: 0.02, Verb.PUT_DOWN: 0.05, Verb.DELIVER: 0.02, Verb.RECHARGE: 0.0}
"""State of charge that each uses."""


@dataclass(frozen=True, slots=True)
class InPlaceAction:
    """An action of the domain as the executor understands it.

    Attributes:
        verb: what is done.
        slot: index into `SLOTS` of what it is done with; -1 for both or none.
        kind: of the item that a collect action asks for, else empty.
        verdict: "correct" or "wrong", what a check is to establish, else empty.
    """

    verb: Verb
    slot: int = -1
    kind: str = ""
    verdict: str = ""

    @property
    def seconds(self) -> float:
        """Its duration."""
        return SECONDS[self.verb]

    @property
    def charge(self) -> float:
        """The state of charge it uses."""
        return CHARGE[self.verb]


_FIXED = {
    "put_down_medicine": InPlaceAction(Verb.PUT_DOWN, slot=0),
    "put_down_supplement": InPlaceAction(Verb.PUT_DOWN, slot=1),
    "deliver_on_bedside_table_left": InPlaceAction(Verb.DELIVER),
    "deliver_on_bedside_table_right": InPlaceAction(Verb.DELIVER),
    "recharge": InPlaceAction(Verb.RECHARGE),
} | {
    f"check_{name}_{verdict}": InPlaceAction(Verb.CHECK, slot=slot, verdict=verdict)
    for slot, name in enumerate(SLOTS)
    for verdict in ("correct", "wrong")
}

_COLLECT = {"collect_med_": 0, "collect_supp_": 1}


def in_place_action(name: str) -> InPlaceAction | None:
    """The in-place action called `name`, or None when there is none of that name."""
    for prefix, slot in _COLLECT.items():
        if name.startswith(prefix) and len(name) > len(prefix):
            return InPlaceAction(Verb.COLLECT, slot=slot, kind=name.removeprefix("collect_"))
    return _FIXED.get(name)
