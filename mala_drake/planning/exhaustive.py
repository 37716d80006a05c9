"""The optimum where steps may lower the metric: every reachable state is visited before an answer is given.

The shortest path in the finite graph of reachable states may use negative steps, but no negative cycle: with one from
which the goal can still be reached, plans get better without end and none is optimal.
"""

from __future__ import annotations

from dataclasses import dataclass

from mala_drake.planning.limits import Budget
from mala_drake.planning.model import Model, State
from mala_drake.planning.numbers import Number
from mala_drake.planning.operators import Operator
from mala_drake.planning.search import Solution


class UnboundedError(Exception):
    """There is no best plan: going round a cycle improves the metric every time."""


@dataclass(frozen=True, slots=True)
class _Edge:
    start: int
    end: int
    operator: Operator
    cost: Number


def exhaustive(model: Model, start: State, *, budget: Budget) -> Solution | None:
    """The cheapest path from `start` to the goal, None if there is none; no step need have a positive cost.

    Of paths with equal cost the one that the order of operator names leads to first wins.

    Raises:
        OutOfBudget: if the budget runs out before all states are known.
        UnboundedError: if there is no cheapest path.
    """
    states, edges = _explore(model, start, budget)
    goals = {}
    for index, state in enumerate(states):
        # The rest of the metric is counted at the end, where it must be defined.
        rest = model.rest(state) if model.is_goal(state) else None
        if rest is not None:
            goals[index] = rest
    if not goals:
        return None
    useful = _leading_to(goals, edges, len(states))
    distances, parents = _shortest([each for each in edges if useful[each.end]], len(states), budget)
    reached = {}
    for index, rest in goals.items():
        distance = distances[index]
        if distance is not None:
            reached[index] = distance + rest
    best = min(reached, key=lambda index: (reached[index], index))
    base = model.rest(start)
    return Solution(_path(parents, best), reached[best] - (base or 0))


def _explore(model: Model, start: State, budget: Budget) -> tuple[list[State], list[_Edge]]:
    numbers = {start: 0}
    states = [start]
    edges: list[_Edge] = []
    for index, state in enumerate(states):
        budget.expand()
        for operator, successor, cost in model.successors(state):
            if successor not in numbers:
                numbers[successor] = len(states)
                states.append(successor)
            edges.append(_Edge(index, numbers[successor], operator, cost))
    return states, edges


def _leading_to(goals: dict[int, Number], edges: list[_Edge], count: int) -> list[bool]:
    before: list[list[int]] = [[] for _ in range(count)]
    for edge in edges:
        before[edge.end].append(edge.start)
    useful = [False] * count
    stack = list(goals)
    while stack:
        index = stack.pop()
        if not useful[index]:
            useful[index] = True
            stack += before[index]
    return useful


def _shortest(edges: list[_Edge], count: int, budget: Budget) -> tuple[list[Number | None], dict[int, _Edge]]:
    """Bellman and Ford's relaxation, at most once a state over all edges."""
    distances: list[Number | None] = [None] * count
    distances[0] = 0
    parents: dict[int, _Edge] = {}
    for _ in range(count):
        changed = False
        budget.tick()
        for edge in edges:
            start, end = distances[edge.start], distances[edge.end]
            if start is not None and (end is None or start + edge.cost < end):
                distances[edge.end] = start + edge.cost
                parents[edge.end] = edge
                changed = True
        if not changed:
            return distances, parents
    raise UnboundedError


def _path(parents: dict[int, _Edge], end: int) -> tuple[Operator, ...]:
    operators = []
    while end in parents:
        edge = parents[end]
        operators.append(edge.operator)
        end = edge.start
    return tuple(reversed(operators))
