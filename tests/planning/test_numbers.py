"""Integers on a common unit and fractions give the same numbers."""

import random
from fractions import Fraction

import pytest

import mala_drake.planning.numbers as mut
from mala_drake.planning.polynomial import evaluate


@pytest.mark.parametrize("name", ["care", "depots", "zenotravel", "counters", "delivery", "sailing"])
def test_every_polynomial_has_its_exact_value(load, name):
    task = load(name)
    grounding = task.grounding(task.initial_state)
    operators = grounding.operators
    generator = random.Random(1)
    for _ in range(3):
        values = dict(task.initial_state.values)
        for fluent in operators.fluents:
            values[fluent] = Fraction(generator.randrange(1000), 1000)
        for weight in ("w0", "w1", "w2"):
            if (weight,) in values:
                values[weight,] = Fraction(generator.randrange(10**6), 10**6)
        numbers = mut.Numbers(grounding.table, values)
        state = numbers.initial()
        for index, polynomial in enumerate(operators.polynomials):
            exact = evaluate(polynomial, values)
            found = numbers.value(index, state)
            if numbers.is_stepwise and polynomial.fluents():
                # A comparison's value carries the unit twice; only its sign is used.
                assert numbers.exact(numbers.exact(found)) == exact
            else:
                assert numbers.exact(found) == exact


def test_the_care_task_is_computed_in_integers_and_the_delivery_task_in_fractions(load):
    for name, expected in (("care", True), ("delivery", False)):
        task = load(name)
        numbers = mut.Numbers(task.grounding(task.initial_state).table, task.initial_state.values)
        assert numbers.is_stepwise is expected


def test_thirds_are_exact_too(load):
    task = load("care")
    table = task.grounding(task.initial_state).table
    values = {**task.initial_state.values, ("w0",): Fraction(1, 3), ("battery-soc", "robot1"): Fraction(2, 7)}
    numbers = mut.Numbers(table, values)
    index = next(i for i, each in enumerate(table.task.polynomials) if ("w0",) in each.statics())
    assert numbers.exact(numbers.constant(index)) == evaluate(table.task.polynomials[index], values)
