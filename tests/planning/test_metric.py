"""Which fluents are mere sums of costs, and what stays in the state."""

from fractions import Fraction

import pytest

from mala_drake.planning import PlanningTask
from mala_drake.planning.polynomial import evaluate


def split_of(metric, effect="", precondition="()"):
    domain = f"""(define (domain d) (:functions (a) (b) (c) (weight))
      (:action act :precondition {precondition}
        :effect (and (increase (a) 1) (increase (b) 2) (increase (c) 3) {effect})))"""
    problem = f"""(define (problem p) (:domain d) (:init (= (a) 0) (= (b) 0) (= (c) 0) (= (weight) 5))
      (:goal (> 1 0)) (:metric {metric}))"""
    task = PlanningTask.parse(domain, problem)
    grounding = task.grounding(task.initial_state)
    values = task.initial_state.values
    weights = {fluent[0]: evaluate(weight, values) for fluent, weight in grounding.split.weights.items()}
    return weights, {fluent[0] for fluent in grounding.operators.fluents}


@pytest.mark.parametrize(
    ("options", "weights", "state"),
    [
        ({"metric": "minimize (+ (a) (* 2 (b)))"}, {"a": 1, "b": 2, "c": 0}, set()),
        ({"metric": "maximize (+ (a) (* (weight) (b)))"}, {"a": -1, "b": -5, "c": 0}, set()),
        ({"metric": "minimize (/ (a) (weight))"}, {"a": Fraction(1, 5), "b": 0, "c": 0}, set()),
        ({"metric": "minimize (* (a) (b))"}, {"c": 0}, {"a", "b"}),
        ({"metric": "minimize (+ (a) (* (a) (b)))"}, {"c": 0}, {"a", "b"}),
        ({"metric": "minimize (/ (a) (b))"}, {"c": 0}, {"a", "b"}),
        ({"metric": "minimize (a)", "precondition": "(< (a) 9)"}, {"b": 0, "c": 0}, {"a"}),
        ({"metric": "minimize (a)", "effect": "(when (> (b) 3) (increase (c) 1))"}, {"a": 1, "c": 0}, {"b"}),
        ({"metric": "minimize (a)", "effect": "(increase (a) (b))"}, {"a": 1, "c": 0}, {"b"}),
    ],
)
def test_only_unread_linear_sums_leave_the_state(options, weights, state):
    assert split_of(**options) == (weights, state)
