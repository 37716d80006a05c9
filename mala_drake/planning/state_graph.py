"""The planner's own state space as a table: every reachable state, every transition, its exact cost (row A5).

Small enough tasks can be solved on it by value iteration and Q-learning, which know nothing of heuristics, dominance or
search: what they find is the truth that the planner, and learned action values (row F5), can be measured against.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from mala_drake.planning.limits import Budget
from mala_drake.planning.model import Model
from mala_drake.planning.numbers import Number
from mala_drake.planning.state import Amount, Name, SymbolicState
from mala_drake.planning.task import PlanningTask

IntArray = npt.NDArray[np.int64]
ExactArray = npt.NDArray[Any]
"""Whole numbers: int64 where all sums along paths fit, Python's own integers where they do not."""

_LARGEST_SUM = 2**62


@dataclass(frozen=True, slots=True, eq=False)
class StateGraph:
    """n states, of which the first is where the task starts, and m transitions, in the order of their first states.

    Attributes:
        starts: (m,), the state before each transition.
        ends: (m,), the state after it.
        costs: (m,), exact, in multiples of `unit`.
        actions: (m,), which of `names` it is.
        names: of the actions that occur.
        goals: (n,), whether a state is a goal; goals have no transitions, a plan ends there.
        unit: what a cost of 1 is in the metric, exactly.
    """

    starts: IntArray
    ends: IntArray
    costs: ExactArray
    actions: IntArray
    names: tuple[str, ...]
    goals: npt.NDArray[np.bool_]
    unit: Fraction

    @property
    def size(self) -> int:
        """The number of states n."""
        return int(self.goals.size)

    @property
    def offsets(self) -> IntArray:
        """(n + 1,): the transitions from state i are those from `offsets[i]` up to `offsets[i + 1]`."""
        return np.searchsorted(self.starts, np.arange(self.size + 1)).astype(np.int64)


def explore(
    task: PlanningTask,
    state: SymbolicState | None = None,
    weights: Mapping[str, Amount] | Sequence[Amount] | None = None,
    *,
    fluents: Mapping[Name, Amount] | None = None,
    max_expansions: int = 1_000_000,
) -> StateGraph:
    """Every state that can be reached, breadth first.

    What only adds up to the metric is no part of a state but the cost of a transition; all other numbers are, so that
    states with different charges are different states.

    Args:
        task: the task.
        state: where it starts, by default its initial state.
        weights: values of the fluents `(w0)`, `(w1)`, ... in order, or by name.
        fluents: values of any other fluents.
        max_expansions: the most states that are not goals.

    Raises:
        BadInput: if the state, weights or fluents name what the task does not have.
        OutOfBudget: if there are more states.
    """
    start = task.with_weights(state or task.initial_state, weights, fluents)
    grounding = task.grounding(start)
    model = Model(grounding.operators, grounding.table, start.values)
    budget = Budget(max_expansions=max_expansions)
    first = (grounding.operators.mask(start.facts), model.numbers.initial())
    numbers, states, goals = {first: 0}, [first], []
    names: dict[str, int] = {}
    transitions = array("q")  # Start, end and action of each, one after another: there may be millions.
    costs: list[Number] = []
    for i, here in enumerate(states):
        goals.append(model.is_goal(here))
        if goals[i]:
            continue
        budget.expand()
        for operator, successor, step in model.successors(here):
            if successor not in numbers:
                numbers[successor] = len(states)
                states.append(successor)
            transitions.extend((i, numbers[successor], names.setdefault(operator.name, len(names))))
            costs.append(step + (model.rest(successor) or 0) - (model.rest(here) or 0))
    starts, ends, actions = np.array(transitions, dtype=np.int64).reshape(-1, 3).T.copy()
    exact, unit = _whole_numbers(costs, model, longest=len(states))
    return StateGraph(starts, ends, exact, actions, tuple(names), np.array(goals, dtype=bool), unit)


def _whole_numbers(costs: Sequence[Number], model: Model, *, longest: int) -> tuple[ExactArray, Fraction]:
    """The costs as multiples of their greatest common unit; `longest` of them may be added up."""
    exact = {cost: model.numbers.exact(cost) for cost in set(costs)}
    below = math.lcm(*(cost.denominator for cost in exact.values()))
    above = math.gcd(*(int(cost * below) for cost in exact.values())) or 1
    unit = Fraction(above, below)
    multiples = {cost: int(value / unit) for cost, value in exact.items()}
    fits = max(map(abs, multiples.values()), default=0) * max(longest, 1) < _LARGEST_SUM
    return np.array([multiples[cost] for cost in costs], dtype=np.int64 if fits else object), unit
