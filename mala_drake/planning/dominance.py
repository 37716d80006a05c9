"""Leaving out states that another state can replace: same facts, no more cost, and no resource worse.

A fluent is a resource that is better high (or better low) if the task itself shows it: every precondition and the goal
get easier with it, it changes by constants only, and what conditional effects hang on it only add cost and get rarer
with it. Then every plan from the worse state also works from the better one, and costs no more there.
"""

from __future__ import annotations

from collections.abc import Iterator

from mala_drake.planning.model import Model, State
from mala_drake.planning.numbers import Number
from mala_drake.planning.operators import Comparison, Condition, OperatorTask

_HIGH, _LOW = 1, -1


class ResourceDominance:
    """Remembers the states worth keeping.

    Args:
        directions: by fluent number, 1 if it is better high and -1 if better low; see `ResourceFinder`.
        count: how many fluents a state has.
    """

    def __init__(self, directions: dict[int, int], count: int) -> None:
        self._directions = tuple(sorted(directions.items()))
        self._others = tuple(index for index in range(count) if index not in directions)
        self._kept: dict[tuple[int, tuple[Number | None, ...]], list[tuple[Number, ...]]] = {}

    def __call__(self, state: State, cost: Number) -> bool:
        """Whether a state at a cost can be left out; if not, it is remembered."""
        mask, values = state
        key = (mask, tuple(values[index] for index in self._others))
        # Cost first, then the resources, all turned so that lower is better.
        label = (cost, *(-direction * (values[index] or 0) for index, direction in self._directions))
        kept = self._kept.setdefault(key, [])
        if any(all(a <= b for a, b in zip(other, label, strict=True)) for other in kept):
            return True
        kept[:] = [other for other in kept if not all(a <= b for a, b in zip(label, other, strict=True))]
        kept.append(label)
        return False


class ResourceFinder:
    """Finds the resources of a task for the numbers of one solve after another.

    Args:
        task: the operators; equal conditions among them are looked at once.
    """

    def __init__(self, task: OperatorTask) -> None:
        conditions = [operator.precondition for operator in task.operators]
        conditions += [task.goal] if task.goal is not None else []
        comparisons = (comparison for condition in conditions for comparison in _comparisons(condition))
        self._needed = tuple(dict.fromkeys(comparisons))
        effects = (effect for operator in task.operators for effect in operator.sometimes)
        # The cost of a conditional effect, or None if it does more than cost, and what it hangs on.
        self._guards = tuple(
            dict.fromkeys(
                (effect.cost, not (effect.added or effect.deleted or effect.updates), comparison)
                for effect in effects
                for comparison in _comparisons(effect.condition)
            )
        )

    def find(self, model: Model, start: State) -> dict[int, int]:
        """The fluents that are provably better high (1) or better low (-1), by number."""
        if not model.numbers.is_stepwise or None in start[1]:
            return {}
        possible = {index: {_HIGH, _LOW} for index in range(len(start[1]))}
        for comparison in self._needed:
            _restrict(model, comparison, possible, wanted=True)
        for cost, only_costs, comparison in self._guards:
            harmful = only_costs and (cost is None or (model.numbers.constant(cost) or 0) >= 0)
            _restrict(model, comparison, possible, wanted=False if harmful else None)
        # A fluent that may go either way is read by nothing; calling it better high is as good as anything.
        return {index: max(directions) for index, directions in possible.items() if directions}


def _comparisons(condition: Condition) -> Iterator[Comparison]:
    yield from condition.comparisons
    for choice in condition.choices:
        for part in choice:
            yield from _comparisons(part)


def _restrict(model: Model, comparison: Comparison, possible: dict[int, set[int]], *, wanted: bool | None) -> None:
    """Drops the directions in which a comparison does not get easier (or, if not `wanted`, harder)."""
    linear = model.numbers.linear(comparison.polynomial)
    if linear is None:
        return  # Undefined, hence false everywhere.
    for index, coefficient in linear[1].items():
        if wanted is None or comparison.operator in ("=", "!="):
            possible[index].clear()
        elif coefficient:
            easier = _HIGH if coefficient > 0 else _LOW
            possible[index].discard(-easier if wanted else easier)
