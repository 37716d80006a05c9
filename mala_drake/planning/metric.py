"""What a plan costs, split into a sum over its actions and a function of the states it visits.

The metric is an expression of the final state. A fluent that only ever grows by increments, that nothing reads, and
that enters the metric linearly is an accumulator: its part of the metric is a sum of action costs, and states that
differ in it alone are the same for everything that can still happen. What remains of the metric, its `rest`, is a
function of the fluents that stay in the state.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from mala_drake.planning.ground_task import Condition, GroundTask, Update
from mala_drake.planning.polynomial import FLUENT, Polynomial, constant, is_static
from mala_drake.planning.syntax import Fact

ZERO = Polynomial(())
ONE = constant(1)


@dataclass(frozen=True, slots=True)
class CostSplit:
    """A metric to be minimised, as `sum of weights[f] * f over accumulators + rest + step * number of actions`."""

    weights: Mapping[Fact, Polynomial]
    rest: Polynomial
    step: Polynomial

    def increment(self, updates: tuple[Update, ...]) -> Polynomial:
        """What the updates of accumulators add to the cost.

        Accumulators of no weight count zero times: their increments must be defined all the same.
        """
        total = ZERO
        for update in updates:
            if update.fluent in self.weights:
                total = total + self.weights[update.fluent] * update.value
        return total


def split_metric(task: GroundTask, metric: Polynomial | None, defined: Collection[Fact]) -> CostSplit:
    """Finds the accumulators of a task.

    Args:
        task: the ground task.
        metric: the expression to minimise, or None to count actions.
        defined: the fluents that have a value at the start; others stay in the state.
    """
    read = frozenset(fluent for polynomial in _polynomials_read(task) for fluent in polynomial.fluents())
    updates = [update for action in task.actions for effect in action.effects for update in effect.updates]
    assigned = frozenset(update.fluent for update in updates if update.kind != "add")
    free = {update.fluent for update in updates} - read - assigned
    weights: dict[Fact, Polynomial] = dict.fromkeys(sorted(free & set(defined)), ZERO)
    terms = metric.terms if metric is not None else ()
    for monomial, _ in terms:
        changing = [atom for atom in monomial if not is_static(atom)]
        if changing and (len(changing) > 1 or changing[0][0] != FLUENT):
            for fluent in Polynomial(((monomial, Fraction(1)),)).fluents():
                weights.pop(fluent, None)
    rest = []
    for monomial, coefficient in terms:
        fluents = [name for kind, name in monomial if kind == FLUENT and name in weights]
        if fluents:
            factor = Polynomial(((tuple(atom for atom in monomial if is_static(atom)), coefficient),))
            weights[fluents[0]] = weights[fluents[0]] + factor
        else:
            rest.append((monomial, coefficient))
    # Weight zero still has one monomial, so that an undefined increment is noticed.
    weights = {fluent: weight if weight.terms else constant(0) for fluent, weight in weights.items()}
    return CostSplit(weights, Polynomial(tuple(rest)), ONE if metric is None else ZERO)


def _polynomials_read(task: GroundTask) -> Iterator[Polynomial]:
    conditions = [action.precondition for action in task.actions]
    conditions += [effect.condition for action in task.actions for effect in action.effects]
    for condition in [*conditions, task.goal or Condition()]:
        for part in condition.parts():
            for comparison in part.comparisons:
                yield comparison.polynomial
    for action in task.actions:
        for effect in action.effects:
            for update in effect.updates:
                yield update.value
