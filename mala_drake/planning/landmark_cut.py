"""The landmark-cut heuristic, for tasks whose facts are too many to project on.

In the delete relaxation, where facts never become false again, it finds sets of operators of which every plan must use
one, charges each set the cost of its cheapest member and lowers the costs of the others by as much, so that no cost is
counted twice: M. Helmert and C. Domshlak, "Landmarks, critical paths and abstractions: what's the difference anyway?",
ICAPS 2009. Numeric conditions, negative preconditions and disjunctions are taken as satisfied.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence

from mala_drake.planning.model import Model, State
from mala_drake.planning.numbers import Number
from mala_drake.planning.operators import Operator

_TRUE = 0  # A fact that always holds: every operator has a precondition.
_GOAL = 1  # A fact that only the goal achieves.
_FIRST = 2


class LandmarkCut:
    """A lower bound on the cost from a state to the goal.

    Args:
        model: the task with its numbers; no step of it may have a negative cost.
        tick: called before each cut, for a bound in a large task may take seconds; may raise to give up.
    """

    def __init__(self, model: Model, tick: Callable[[], None] = lambda: None) -> None:
        self._tick = tick
        task = model.task
        assert task.goal is not None
        self._facts = len(task.facts) + _FIRST
        # One entry an operator: what it needs, what it may add, what it costs at least.
        self._needs: list[tuple[int, ...]] = [_bits(task.goal.positive) or (_TRUE,)]
        self._adds: list[tuple[int, ...]] = [(_GOAL,)]
        self._costs: list[Number] = [0]
        for operator in task.operators:
            added = operator.always.added
            for effect in operator.sometimes:
                # Whatever its condition: the operator may add it, which only makes the relaxation weaker.
                added |= effect.added
            if added:
                self._needs.append(_bits(operator.precondition.positive) or (_TRUE,))
                self._adds.append(_bits(added))
                self._costs.append(_least_cost(operator, model))
        self._needing: list[list[int]] = [[] for _ in range(self._facts)]
        self._adding: list[list[int]] = [[] for _ in range(self._facts)]
        for index, (needs, adds) in enumerate(zip(self._needs, self._adds, strict=True)):
            for fact in needs:
                self._needing[fact].append(index)
            for fact in adds:
                self._adding[fact].append(index)
        self._known: dict[int, Number | None] = {}

    def __call__(self, state: State) -> Number | None:
        """The bound in a state, None if the goal cannot be reached even in the relaxation."""
        mask = state[0]
        if mask not in self._known:
            self._known[mask] = self._evaluate((_TRUE, *_bits(mask)))
        return self._known[mask]

    def _evaluate(self, start: Sequence[int]) -> Number | None:
        costs = list(self._costs)
        total: Number = 0
        while True:
            self._tick()
            levels, supporters = self._hmax(start, costs)
            level = levels[_GOAL]
            if level is None:
                return None
            if level == 0:
                return total
            cut = self._cut(start, supporters, costs)
            charge = min(costs[index] for index in cut)
            for index in cut:
                costs[index] -= charge
            total += charge

    def _hmax(self, start: Sequence[int], costs: list[Number]) -> tuple[list[Number | None], list[int]]:
        """The level of every fact, and for every operator the fact it waited for last (-1 if it never could act)."""
        levels: list[Number | None] = [None] * self._facts
        missing = [len(needs) for needs in self._needs]
        supporters = [-1] * len(self._needs)
        queue: list[tuple[Number, int]] = []
        for fact in start:
            levels[fact] = 0
            queue.append((0, fact))
        while queue:
            level, fact = heapq.heappop(queue)
            if level != levels[fact]:
                continue
            for index in self._needing[fact]:
                missing[index] -= 1
                if missing[index]:
                    continue
                supporters[index] = fact
                reached = level + costs[index]
                for added in self._adds[index]:
                    known = levels[added]
                    if known is None or reached < known:
                        levels[added] = reached
                        heapq.heappush(queue, (reached, added))
        return levels, supporters

    def _cut(self, start: Sequence[int], supporters: list[int], costs: list[Number]) -> list[int]:
        """The operators that lead into the facts from which the goal is free of charge."""
        near = {_GOAL}
        stack = [_GOAL]
        while stack:
            for index in self._adding[stack.pop()]:
                supporter = supporters[index]
                if supporter >= 0 and not costs[index] and supporter not in near:
                    near.add(supporter)
                    stack.append(supporter)
        waiting: dict[int, list[int]] = {}
        for index, supporter in enumerate(supporters):
            waiting.setdefault(supporter, []).append(index)
        cut: dict[int, None] = {}
        seen = set(start)
        stack = list(start)
        while stack:
            for index in waiting.get(stack.pop(), ()):
                if any(added in near for added in self._adds[index]):
                    cut[index] = None
                    continue
                for added in self._adds[index]:
                    if added not in seen:
                        seen.add(added)
                        stack.append(added)
        return list(cut)


def _bits(mask: int) -> tuple[int, ...]:
    facts = []
    while mask:
        lowest = mask & -mask
        facts.append(lowest.bit_length() - 1 + _FIRST)
        mask ^= lowest
    return tuple(facts)


def _least_cost(operator: Operator, model: Model) -> Number:
    total: Number = 0
    if operator.always.cost is not None:
        constant = model.numbers.constant(operator.always.cost)
        if constant is None:
            return 0  # It depends on the state; that it is not negative is all that is known.
        total = constant
    for effect in operator.sometimes:
        if effect.cost is not None:
            constant = model.numbers.constant(effect.cost)
            if constant is None:
                return 0
            total += min(constant, 0)
    return max(total, 0)
