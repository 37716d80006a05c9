"""What a planner answers."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

from mala_drake.planning.syntax import Fact

Status = Literal["optimal", "unsolvable", "timeout"]


@dataclass(frozen=True, slots=True)
class Plan:
    """A plan, or why there is none; immutable, so that it can be a message.

    Attributes:
        status: `optimal`, `unsolvable`, or `timeout` if a limit was reached before the answer was known.
        cost: the metric's value after the plan, exactly; the number of actions if there is no metric; None without
            a plan.
        actions: each as `(name object ...)`.
        expanded: states expanded by the search.
        search_ms: milliseconds of search.
        parse_ms: milliseconds it took to read the files.
        ground_ms: milliseconds of grounding, 0 where an earlier grounding was used.
    """

    status: Status
    cost: Fraction | None
    actions: tuple[str, ...]
    expanded: int = 0
    search_ms: float = 0.0
    parse_ms: float = 0.0
    ground_ms: float = 0.0

    def __deepcopy__(self, memo: dict[int, object]) -> Plan:
        return self

    @property
    def found(self) -> bool:
        """Whether there is a plan (perhaps an empty one)."""
        return self.status == "optimal"

    def steps(self) -> tuple[Fact, ...]:
        """The actions as tuples of names."""
        return tuple(tuple(action.strip("()").split()) for action in self.actions)


def plan_to_json(plan: Plan) -> dict[str, Any]:
    """A plan as `plan --json` prints it."""
    return {
        "status": plan.status,
        "cost": None if plan.cost is None else _as_number(plan.cost),
        "actions": list(plan.actions),
        "expanded": plan.expanded,
        "search_ms": round(plan.search_ms, 3),
        "parse_ms": round(plan.parse_ms, 3),
        "ground_ms": round(plan.ground_ms, 3),
    }


def _as_number(cost: Fraction) -> int | float:
    if cost.denominator == 1:
        return cost.numerator
    try:
        return float(cost)
    except OverflowError:
        return round(cost)
