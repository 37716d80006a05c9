import pytest

import mala_drake.planning.projection as mut
from mala_drake.planning import Planner, PlanningTask
from mala_drake.planning.limits import Budget
from mala_drake.planning.model import Model


def heuristic_of(task, state=None):
    state = state or task.initial_state
    grounding = task.grounding(state)
    model = Model(grounding.operators, grounding.table, state.values)
    start = (grounding.operators.mask(state.facts), model.numbers.initial())
    assert grounding.graph.explore(start[0], Budget())
    return model, start, mut.ProjectionHeuristic(grounding.graph, model)


@pytest.mark.parametrize("name", ["hanoi", "gripper", "logistics", "lift", "briefcase"])
def test_is_exact_without_numeric_conditions(load, name):
    task = load(name)
    model, start, heuristic = heuristic_of(task)
    assert model.numbers.exact(heuristic(start)) == Planner(task, "ucs").solve().cost


@pytest.mark.parametrize("battery", [1.0, 0.4, 0.3])
def test_is_a_lower_bound_when_the_battery_bites(load, battery):
    task = load("care")
    state = task.initial_state.with_fluents({"(battery-soc robot1)": battery})
    model, start, heuristic = heuristic_of(task, state)
    assert model.numbers.exact(heuristic(start)) <= Planner(task).solve(state).cost


def test_effects_that_hang_on_numbers_may_happen_or_not():
    domain = """(define (domain d) (:predicates (p) (q)) (:functions (x))
      (:action a :effect (and (increase (x) 1) (when (> (x) 3) (p)))) (:action b :precondition (p) :effect (q)))"""
    problem = "(define (problem p) (:domain d) (:init (= (x) 0)) (:goal (and (q))))"
    task = PlanningTask.parse(domain, problem)
    model, start, heuristic = heuristic_of(task)
    assert model.numbers.exact(heuristic(start)) == 2
    assert Planner(task).solve().cost == 6


def test_a_graph_that_is_too_large_is_given_up(load):
    task = load("blocks")
    grounding = task.grounding(task.initial_state)
    start = grounding.operators.mask(task.initial_state.facts)
    assert not grounding.graph.explore(start, Budget())
    assert not grounding.graph.explore(0, Budget())
