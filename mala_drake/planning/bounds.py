"""Proof that no step of a task lowers the metric, which is what best-first search needs to be right.

Intervals bound every fluent over all reachable states; then the change that each operator makes to the metric is formed
as a polynomial and bounded below. What cannot be proven this way is left to `exhaustive`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from mala_drake.planning.model import Model
from mala_drake.planning.numbers import Number
from mala_drake.planning.operators import Effect, Operator, OperatorTask, Update
from mala_drake.planning.polynomial import FLUENT, INVERSE, Polynomial, constant, evaluate, variable
from mala_drake.planning.syntax import Fact

Bound = Fraction | float  # A float is an infinity.

_MOST_CONDITIONAL = 5  # Conditional effects on the metric in one operator: each doubles the cases to look at.


@dataclass(frozen=True, slots=True)
class Interval:
    """Every number from `low` to `high`."""

    low: Bound
    high: Bound

    def __add__(self, other: Interval) -> Interval:
        return Interval(_sum(self.low, other.low), _sum(self.high, other.high))

    def __mul__(self, other: Interval) -> Interval:
        corners = [_product(a, b) for a in (self.low, self.high) for b in (other.low, other.high)]
        return Interval(min(corners), max(corners))

    def hull(self, other: Interval) -> Interval:
        """The smallest interval around both."""
        return Interval(min(self.low, other.low), max(self.high, other.high))


EVERYTHING = Interval(-math.inf, math.inf)
Ranges = Mapping[Fact, Interval]


def never_gains(model: Model, values: Mapping[Fact, Fraction]) -> bool:
    """Whether it is certain that no step from any reachable state lowers the cost, and that it stays defined.

    Args:
        model: the task with its numbers.
        values: every fluent that has a value at the start.
    """
    task = model.task
    if model.numbers.is_stepwise:
        return all(_constant_step_cost(model, *costs) >= 0 for costs in task.step_costs)
    rest = constant(0) if task.rest is None else _fill_in(task.polynomials[task.rest], values)
    if rest is None or any(kind == INVERSE for kind, _ in rest.atoms()) or not rest.fluents() <= values.keys():
        return False
    ranges = fluent_ranges(task, values)
    return all(_changes_upward(task, operator, rest, ranges, values) for operator in task.operators)


def _constant_step_cost(model: Model, always: int | None, sometimes: tuple[int, ...]) -> Number:
    total: Number = 0 if always is None else model.numbers.constant(always) or 0
    for cost in sometimes:
        total += min(model.numbers.constant(cost) or 0, 0)
    return total


def fluent_ranges(task: OperatorTask, values: Mapping[Fact, Fraction]) -> dict[Fact, Interval]:
    """An interval for every fluent of the state that holds in all reachable states."""
    names = list(task.fluents)
    ranges = {name: Interval(values[name], values[name]) for name in names if name in values}
    effects = [effect for operator in task.operators for effect in (operator.always, *operator.sometimes)]
    updates = [update for effect in effects for update in effect.updates]
    # Each round either changes nothing or stretches a bound; what still moves after a few goes to infinity.
    for attempt in itertools.count():
        before = dict(ranges)
        for update in updates:
            name = names[update.fluent]
            reached = _after_update(task, update, name, ranges, values)
            known = ranges.get(name)
            if reached is not None:
                ranges[name] = reached if known is None else known.hull(reached)
                if attempt > len(names) + 2 and known is not None:
                    low = known.low if ranges[name].low == known.low else -math.inf
                    high = known.high if ranges[name].high == known.high else math.inf
                    ranges[name] = Interval(low, high)
        if ranges == before:
            return ranges
    raise AssertionError  # pragma: no cover


def _after_update(
    task: OperatorTask, update: Update, name: Fact, ranges: Ranges, values: Mapping[Fact, Fraction]
) -> Interval | None:
    polynomial = _fill_in(task.polynomials[update.value], values)
    if polynomial is None or not all(fluent in ranges for fluent in polynomial.fluents()):
        return None  # Undefined as yet: the operator cannot be applied.
    amount = range_of(polynomial, ranges)
    if update.kind == "set":
        return amount
    if name not in ranges:
        return None
    known = ranges[name]
    if update.kind == "scale":
        # Repeated at will: a factor may be applied any number of times, so only its sign and size matter.
        return known * amount
    # So may a sum: one that can go up can go up without end.
    return Interval(-math.inf if amount.low < 0 else known.low, math.inf if amount.high > 0 else known.high)


def range_of(polynomial: Polynomial, ranges: Ranges) -> Interval:
    """An interval that contains the polynomial's values."""
    total = Interval(Fraction(0), Fraction(0))
    for monomial, coefficient in polynomial.terms:
        product = Interval(coefficient, coefficient)
        for kind, name in monomial:
            product = product * (ranges.get(name, EVERYTHING) if kind == FLUENT else EVERYTHING)
        total = total + product
    return total


def _changes_upward(
    task: OperatorTask, operator: Operator, rest: Polynomial, ranges: Ranges, values: Mapping[Fact, Fraction]
) -> bool:
    names = list(task.fluents)
    counted = {task.fluents[name] for name in rest.fluents()}
    always, sometimes = operator.always, operator.sometimes
    relevant = [each for each in sometimes if each.cost is not None or any(u.fluent in counted for u in each.updates)]
    if len(relevant) > _MOST_CONDITIONAL:
        return False
    for chosen in itertools.product((False, True), repeat=len(relevant)):
        effects = [always, *(effect for effect, fires in zip(relevant, chosen, strict=True) if fires)]
        change = _change(task, effects, rest, names, values)
        # A change that is undefined means that the operator is not applicable.
        if change is not None and range_of(change, ranges).low < 0:
            return False
    return True


def _change(
    task: OperatorTask, effects: list[Effect], rest: Polynomial, names: list[Fact], values: Mapping[Fact, Fraction]
) -> Polynomial | None:
    total = constant(0)
    after: dict[Fact, Polynomial] = {}
    for effect in effects:
        if effect.cost is not None:
            cost = _fill_in(task.polynomials[effect.cost], values)
            if cost is None:
                return None
            total = total + cost
        for update in effect.updates:
            amount = _fill_in(task.polynomials[update.value], values)
            if amount is None:
                return None
            name = names[update.fluent]
            before = after.get(name, variable(name, static=False))
            after[name] = {"set": amount, "add": before + amount, "scale": before * amount}[update.kind]
    return total + _substitute(rest, after) - rest


def _substitute(polynomial: Polynomial, replacements: Mapping[Fact, Polynomial]) -> Polynomial:
    total = constant(0)
    for monomial, coefficient in polynomial.terms:
        product = constant(coefficient)
        for _, name in monomial:
            product = product * replacements.get(name, variable(name, static=False))
        total = total + product
    return total


def _fill_in(polynomial: Polynomial, values: Mapping[Fact, Fraction]) -> Polynomial | None:
    """The polynomial with numbers for everything static; None if that is undefined."""
    total = constant(0)
    for monomial, coefficient in polynomial.terms:
        product = constant(coefficient)
        for atom in monomial:
            factor = Polynomial((((atom,), Fraction(1)),))
            if not factor.fluents():
                value = evaluate(factor, values)
                if value is None:
                    return None
                factor = constant(value)
            product = product * factor
        total = total + product
    return total


# A fraction may be too large for a float, so it is never added to an infinity or multiplied by one.


def _sum(left: Bound, right: Bound) -> Bound:
    if isinstance(left, float):
        return left
    return right if isinstance(right, float) else left + right


def _product(left: Bound, right: Bound) -> Bound:
    if left == 0 or right == 0:
        return Fraction(0)
    if isinstance(left, float) or isinstance(right, float):
        return math.inf if (left > 0) == (right > 0) else -math.inf
    return left * right
