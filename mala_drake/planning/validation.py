"""Checks plans against the task as it is written, sharing nothing with grounding and search."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

from mala_drake.errors import BadInput
from mala_drake.planning.interpreter import Interpreter
from mala_drake.planning.state import SymbolicState
from mala_drake.planning.task import PlanningTask


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of a plan.

    Attributes:
        valid: every action was applicable in turn and the goal holds in the end.
        cost: the metric after the plan (the number of actions if there is none), None if invalid or undefined.
        reason: why it is not valid, in one line; empty if it is.
    """

    valid: bool
    cost: Fraction | None
    reason: str = ""


def validate_plan(task: PlanningTask, actions: Iterable[str], *, state: SymbolicState | None = None) -> Verdict:
    """Executes a plan step by step, by default from the initial state."""
    interpreter = Interpreter(task.description)
    current = state or task.initial_state
    count = 0
    for action in actions:
        count += 1
        try:
            current = interpreter.apply(current, action)
        except (BadInput, ValueError) as error:
            return Verdict(False, None, f"step {count}: {error}")
    if not interpreter.is_goal(current):
        return Verdict(False, None, f"the goal does not hold after {count} steps")
    if task.description.metric is None:
        return Verdict(True, Fraction(count))
    cost = interpreter.metric_value(current)
    return Verdict(cost is not None, cost, "" if cost is not None else "the metric is undefined after the plan")
