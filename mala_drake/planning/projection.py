"""A heuristic that looks at facts alone, with every number at its best.

The facts of a task form a small graph of their own if numeric conditions are taken as satisfied. It is explored once
and kept; for new numbers only the shortest distances to the goal are computed again, backward. In a task without
numeric conditions the heuristic is exact.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass

from mala_drake.planning.limits import Budget
from mala_drake.planning.model import Model, State
from mala_drake.planning.numbers import Number
from mala_drake.planning.operators import Condition, Effect, Operator, OperatorTask

_MOST_NODES = 4_000
_MOST_UNCERTAIN = 3  # Conditional effects on facts, in one operator, that hang on numbers: each doubles the successors.
_UNKNOWN = -1  # Stands for a cost that was not looked at yet; no cost is negative.


@dataclass(frozen=True, slots=True)
class _Step:
    """An operator with the costs it surely (`certain`) and perhaps (`possible`) has, as polynomial numbers."""

    operator: Operator
    certain: tuple[int, ...]
    possible: tuple[int, ...]


class FactGraph:
    """The reachable fact masks of a task, numbers ignored, and the steps between them."""

    def __init__(self, task: OperatorTask) -> None:
        self._task = task
        self.nodes: dict[int, int] = {}
        self.incoming: list[list[tuple[int, int]]] = []  # By node: where from, and the number of the step.
        self.steps: dict[_Step, int] = {}
        self.goals: list[int] = []
        self.is_too_large = False

    def explore(self, mask: int, budget: Budget) -> bool:
        """Adds what `mask` can reach; False if that is more than a heuristic should cost.

        Raises:
            OutOfBudget: if the time is up; the graph is then as it was before.
        """
        if mask not in self.nodes and not self.is_too_large:
            # In a copy: half a graph would pass for a whole one when it is next asked for.
            grown = self._copy()
            grown._grow(mask, budget)
            self.nodes, self.incoming, self.steps, self.goals = grown.nodes, grown.incoming, grown.steps, grown.goals
            self.is_too_large = grown.is_too_large
        return not self.is_too_large

    def _copy(self) -> FactGraph:
        copy = FactGraph(self._task)
        copy.nodes, copy.steps, copy.goals = dict(self.nodes), dict(self.steps), list(self.goals)
        copy.incoming = [list(each) for each in self.incoming]
        return copy

    def _grow(self, mask: int, budget: Budget) -> None:
        queue = [self._add(mask)]
        masks = list(self.nodes)
        for node in queue:
            budget.tick()
            if self._is_surely_goal(masks[node]):
                continue  # No plan goes on from there: no step has a negative cost.
            for step, successor in self._steps_from(masks[node]):
                if successor not in self.nodes:
                    queue.append(self._add(successor))
                    masks.append(successor)
                number = self.steps.setdefault(step, len(self.steps))
                self.incoming[self.nodes[successor]].append((node, number))
            if len(self.nodes) > _MOST_NODES or self.is_too_large:
                self.is_too_large = True
                return

    def _add(self, mask: int) -> int:
        node = self.nodes.setdefault(mask, len(self.nodes))
        self.incoming.append([])
        if self._task.goal is not None and may_hold(self._task.goal, mask):
            self.goals.append(node)
        return node

    def _is_surely_goal(self, mask: int) -> bool:
        goal = self._task.goal
        return goal is not None and not goal.reads_numbers and may_hold(goal, mask)

    def _steps_from(self, mask: int) -> list[tuple[_Step, int]]:
        result = []
        for operator in self._task.candidates(mask):
            if not may_hold(operator.precondition, mask):
                continue
            certain, uncertain = _fired(operator, mask)
            changing = [effect for effect in uncertain if effect.added or effect.deleted]
            if len(changing) > _MOST_UNCERTAIN:
                self.is_too_large = True
                return []
            costs = tuple(each.cost for each in certain if each.cost is not None)
            step = _Step(operator, costs, tuple(each.cost for each in uncertain if each.cost is not None))
            for chosen in range(1 << len(changing)):
                some = [effect for bit, effect in enumerate(changing) if chosen >> bit & 1]
                result.append((step, _after(mask, [*certain, *some])))
        return result


def may_hold(condition: Condition, mask: int) -> bool:
    """Whether a condition can be true with these facts and some numbers."""
    if mask & condition.positive != condition.positive or mask & condition.negative:
        return False
    return all(any(may_hold(part, mask) for part in choice) for choice in condition.choices)


class ProjectionHeuristic:
    """The distance to the goal in the fact graph, a lower bound on the cost from any state with those facts.

    Args:
        graph: the explored graph; must contain the facts of every state asked for.
        model: the numbers to use. No step of it may have a negative cost.
    """

    def __init__(self, graph: FactGraph, model: Model) -> None:
        self._graph = graph
        self._model = model
        self._steps = tuple(graph.steps)
        self._costs: list[Number | None] = [_UNKNOWN] * len(self._steps)
        self._distances: list[Number | None] = [None] * len(graph.nodes)
        self._settled = bytearray(len(graph.nodes))
        self._queue: list[tuple[Number, int]] = [(0, node) for node in graph.goals]
        for node in graph.goals:
            self._distances[node] = 0

    def __call__(self, state: State) -> Number | None:
        """The bound in a state, None if no way to the goal is left.

        Dijkstra's search goes backward from the goal just as far as it has been asked: towards the end of a task most
        of the graph is farther from the goal than the robot.
        """
        node = self._graph.nodes[state[0]]
        if not self._settled[node]:
            self._settle(node)
        return self._distances[node] if self._settled[node] else None

    def _settle(self, wanted: int) -> None:
        distances, costs, settled, queue = self._distances, self._costs, self._settled, self._queue
        incoming = self._graph.incoming
        while queue and not settled[wanted]:
            distance, node = heapq.heappop(queue)
            if settled[node]:
                continue
            settled[node] = 1
            for before, step in incoming[node]:
                if settled[before]:
                    continue
                cost = costs[step]
                if cost == _UNKNOWN:
                    cost = costs[step] = _lower_bound(self._steps[step], self._model)
                if cost is None:
                    continue
                reached = distance + cost
                known = distances[before]
                if known is None or reached < known:
                    distances[before] = reached
                    heapq.heappush(queue, (reached, before))


def _lower_bound(step: _Step, model: Model) -> Number | None:
    numbers = model.numbers
    for comparison in step.operator.precondition.comparisons:
        if numbers.constant(comparison.polynomial) is not None and not numbers.holds(comparison, ()):
            return None  # Never applicable with these constants.
    certain = [numbers.constant(cost) for cost in step.certain]
    possible = [numbers.constant(cost) for cost in step.possible]
    total: Number = 0
    for value in certain:
        if value is None:
            return 0  # It depends on the state: all that is known is that it is not negative.
        total += value
    for value in possible:
        if value is None:
            return 0
        total += min(value, 0)
    return max(total, 0)


def _fired(operator: Operator, mask: int) -> tuple[list[Effect], list[Effect]]:
    certain, uncertain = [operator.always], list[Effect]()
    for effect in operator.sometimes:
        if may_hold(effect.condition, mask):
            (uncertain if effect.condition.reads_numbers else certain).append(effect)
    return certain, uncertain


def _after(mask: int, effects: list[Effect]) -> int:
    added = deleted = 0
    for effect in effects:
        added |= effect.added
        deleted |= effect.deleted
    return (mask & ~deleted) | added
