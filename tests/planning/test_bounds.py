"""What is claimed never to gain never gains: claims against the steps of whole state spaces, and doubts where due."""

import math
from fractions import Fraction

import pytest

import mala_drake.planning.bounds as mut
from mala_drake.planning import PlanningTask
from mala_drake.planning.model import Model


def claim(effect, metric, *, precondition="(< (n) 4)", init="(= (n) 0) (= (x) 1) (= (y) 2) (= (c) 0)"):
    domain = f"""(define (domain d) (:predicates (p)) (:functions (n) (x) (y) (c))
      (:action a :precondition {precondition} :effect (and (increase (n) 1) {effect})))"""
    problem = f"(define (problem p) (:domain d) (:init {init}) (:goal (> (n) 1)) (:metric {metric}))"
    task = PlanningTask.parse(domain, problem)
    grounding = task.grounding(task.initial_state)
    values = task.initial_state.values
    return mut.never_gains(Model(grounding.operators, grounding.table, values), values)


@pytest.mark.parametrize(
    ("effect", "metric"),
    [
        ("(increase (c) 1)", "minimize (c)"),
        ("(increase (c) 0)", "minimize (c)"),
        ("(increase (c) (x))", "minimize (c)"),
        ("(decrease (c) 1)", "maximize (c)"),
        ("(increase (c) (n))", "minimize (c)"),
        ("(increase (c) (* (n) (x)))", "minimize (+ (c) (* 2 (n)))"),
        ("(and (increase (x) 1) (increase (y) (x)))", "minimize (* (x) (y))"),
        ("(scale-up (x) 3)", "minimize (* 0.5 (x))"),
        ("(when (p) (increase (c) 1))", "minimize (c)"),
        ("(and (increase (c) 2) (when (p) (decrease (c) 1)))", "minimize (c)"),
        ("(decrease (x) 1)", "minimize (- (c) (x))"),
        ("(and (increase (x) 1e400) (increase (c) (x)))", "minimize (+ (c) (* (x) (x)))"),
    ],
)
def test_growing_metrics_are_recognised(effect, metric):
    assert claim(effect, metric)


@pytest.mark.parametrize(
    ("effect", "metric"),
    [
        ("(decrease (c) 1)", "minimize (c)"),
        ("(increase (c) 1)", "maximize (c)"),
        ("(and (p) (when (p) (decrease (c) 1)))", "minimize (c)"),
        ("(and (decrease (x) 1) (increase (c) (x)))", "minimize (c)"),
        ("(assign (n) 0)", "minimize (n)"),
        ("(decrease (y) 1)", "minimize (* (n) (y))"),
        ("(increase (x) 1)", "minimize (/ (y) (x))"),
        ("(scale-up (x) -1)", "minimize (* (n) (x))"),
        ("(and (increase (x) 1e400) (increase (c) (x)))", "minimize (- (c) (* (x) (x)))"),
    ],
)
def test_metrics_that_may_fall_are_not_claimed(effect, metric):
    assert not claim(effect, metric)


def test_ranges_hold_for_every_reachable_value():
    domain = """(define (domain d) (:functions (x) (y) (z))
      (:action up :precondition (< (x) 9) :effect (increase (x) 2)) (:action set :effect (assign (y) (* -1 (x))))
      (:action half :effect (scale-up (z) 0.5)))"""
    problem = (
        "(define (problem p) (:domain d) (:init (= (x) 1) (= (y) 5) (= (z) 8)) (:goal (and (> (+ (x) (y) (z)) 99))))"
    )
    task = PlanningTask.parse(domain, problem)
    operators = task.grounding(task.initial_state).operators
    ranges = mut.fluent_ranges(operators, task.initial_state.values)
    assert ranges["x",].low == 1
    assert ranges["y",].high == 5
    assert ranges["z",].high == 8
    state = task.initial_state
    for action in ("(up)", "(set)", "(half)", "(up)", "(set)", "(half)"):
        state = task.apply(state, action)
        for fluent, interval in ranges.items():
            assert interval.low <= state.value(fluent) <= interval.high


HUGE = Fraction(10) ** 400  # No float is as large.


@pytest.mark.parametrize(
    ("left", "right", "total", "product"),
    [
        ((HUGE, HUGE), (1, math.inf), (HUGE + 1, math.inf), (HUGE, math.inf)),
        ((-HUGE, -HUGE), (1, math.inf), (1 - HUGE, math.inf), (-math.inf, -HUGE)),
        ((-HUGE, HUGE), (-math.inf, -1), (-math.inf, HUGE - 1), (-math.inf, math.inf)),
        ((0, HUGE), (-math.inf, math.inf), (-math.inf, math.inf), (-math.inf, math.inf)),
        ((-math.inf, -2), (-math.inf, -HUGE), (-math.inf, -HUGE - 2), (2 * HUGE, math.inf)),
    ],
)
def test_numbers_beyond_all_floats_and_infinities_go_together(left, right, total, product):
    a, b = mut.Interval(*left), mut.Interval(*right)
    assert a + b == b + a == mut.Interval(*total)
    assert a * b == b * a == mut.Interval(*product)
