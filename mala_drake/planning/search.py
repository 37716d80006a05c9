"""Best-first search: A* with re-opening, of which uniform-cost search is the case without a heuristic."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass

from mala_drake.planning.limits import Budget
from mala_drake.planning.model import Model, State
from mala_drake.planning.numbers import Number
from mala_drake.planning.operators import Operator

Heuristic = Callable[[State], Number | None]  # A lower bound on the cost to the goal; None if there is no way.
Dominated = Callable[[State, Number], bool]  # Whether a state at a cost can be left out.


@dataclass(frozen=True, slots=True)
class Solution:
    """A path to the goal and its cost in the numbers of the model, relative to the start."""

    operators: tuple[Operator, ...]
    cost: Number


def no_heuristic(state: State) -> Number | None:  # noqa: ARG001
    """Zero: turns A* into uniform-cost search."""
    return 0


def no_dominance(state: State, cost: Number) -> bool:  # noqa: ARG001
    """Never: every state counts."""
    return False


def best_first(
    model: Model,
    start: State,
    *,
    heuristic: Heuristic = no_heuristic,
    dominated: Dominated = no_dominance,
    budget: Budget,
) -> Solution | None:
    """The cheapest path from `start` to the goal, None if there is none.

    Requires that no step has a negative cost. The heuristic need only be admissible: a state reached more cheaply is
    opened again. Of paths with equal cost the one found first wins; states with equal bounds are expanded deepest
    first, then oldest first, and operators are tried in the order of their names, so the answer never varies.

    Raises:
        OutOfBudget: if the budget runs out.
    """
    bound = heuristic(start)
    if bound is None:
        return None
    costs: dict[State, Number] = {start: 0}
    parents: dict[State, tuple[State, Operator]] = {}
    queue: list[tuple[Number, Number, int, State]] = [(bound, 0, 0, start)]
    pushed = 0
    while queue:
        _, negative_cost, _, state = heapq.heappop(queue)
        cost = -negative_cost
        if cost > costs[state]:
            continue  # Reached more cheaply since.
        if model.is_goal(state):
            return Solution(_path(parents, start, state), cost)
        budget.expand()
        before = model.rest(state)
        for operator, successor, step in model.successors(state):
            after = model.rest(successor)
            assert before is not None
            assert after is not None
            reached = cost + step + after - before
            known = costs.get(successor)
            if known is not None and known <= reached:
                continue
            budget.tick()  # A state may have many successors, and a bound may take long.
            bound = heuristic(successor)
            if bound is None or dominated(successor, reached):
                continue
            costs[successor] = reached
            parents[successor] = (state, operator)
            pushed += 1
            heapq.heappush(queue, (reached + bound, -reached, pushed, successor))
    return None


def _path(parents: dict[State, tuple[State, Operator]], start: State, end: State) -> tuple[Operator, ...]:
    operators = []
    while end != start:
        end, operator = parents[end]
        operators.append(operator)
    return tuple(reversed(operators))
