"""The state space of one solve: what holds in a state, and where an operator leads.

A state is a pair of the facts as a bit mask and the values of the numeric fluents.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from mala_drake.planning.numbers import Number, Numbers, NumberTable, Values
from mala_drake.planning.operators import Condition, Effect, Operator, OperatorTask
from mala_drake.planning.syntax import Fact

State = tuple[int, Values]


class Model:
    """Operators with the numbers of this solve.

    Args:
        task: the operators.
        table: its polynomials.
        values: every fluent that has a value.
    """

    def __init__(self, task: OperatorTask, table: NumberTable, values: Mapping[Fact, Fraction]) -> None:
        self.task = task
        self.numbers = Numbers(table, values)

    def holds(self, condition: Condition, state: State) -> bool:
        """Whether a condition is true in a state."""
        mask, values = state
        if mask & condition.positive != condition.positive or mask & condition.negative:
            return False
        for comparison in condition.comparisons:
            if not self.numbers.holds(comparison, values):
                return False
        return all(any(self.holds(part, state) for part in choice) for choice in condition.choices)

    def is_goal(self, state: State) -> bool:
        """Whether the goal is true in a state."""
        return self.task.goal is not None and self.holds(self.task.goal, state)

    def rest(self, state: State) -> Number | None:
        """The part of the metric that is a function of the state; None where it is undefined."""
        return 0 if self.task.rest is None else self.numbers.value(self.task.rest, state[1])

    def successors(self, state: State) -> Iterator[tuple[Operator, State, Number]]:
        """Every applicable operator by name, the state after it and what it adds to the cost."""
        for operator in self.task.candidates(state[0]):
            result = self.apply(operator, state)
            if result is not None:
                yield operator, *result

    def apply(self, operator: Operator, state: State) -> tuple[State, Number] | None:
        """The state after an operator and its cost; None if it is not applicable.

        Conditional effects look at the state before; deletions come before additions. An operator is not applicable
        where an effect is undefined or two effects set one fluent in ways that do not commute.
        """
        if not self.holds(operator.precondition, state):
            return None
        effects = [operator.always]
        effects += [effect for effect in operator.sometimes if self.holds(effect.condition, state)]
        mask, values = state
        added = deleted = 0
        cost: Number = 0
        for effect in effects:
            added |= effect.added
            deleted |= effect.deleted
            if effect.cost is not None:
                increment = self.numbers.value(effect.cost, values)
                if increment is None:
                    return None
                cost += increment
        updated = self._updated(effects, values)
        return None if updated is None else (((mask & ~deleted) | added, updated), cost)

    def _updated(self, effects: list[Effect], values: Values) -> Values | None:
        updates = [update for effect in effects for update in effect.updates]
        if not updates:
            return values
        changed = list(values)
        kinds: dict[int, tuple[str, Number]] = {}
        for update in updates:
            amount = self.numbers.value(update.value, values)
            before = values[update.fluent]
            if amount is None or (before is None and update.kind != "set"):
                return None
            if update.fluent in kinds:
                kind, first = kinds[update.fluent]
                if kind != update.kind or (kind == "set" and first != amount):
                    return None
                before = changed[update.fluent]
            kinds[update.fluent] = (update.kind, amount)
            changed[update.fluent] = _combine(update.kind, before, amount)
        return tuple(changed)


def _combine(kind: str, before: Number | None, amount: Number) -> Number:
    if kind == "set" or before is None:
        return amount
    result = before + amount if kind == "add" else before * amount
    return result if type(result) is int or result.denominator != 1 else result.numerator
