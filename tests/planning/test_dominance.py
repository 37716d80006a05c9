"""Only what the task itself shows to be a resource counts as one, and leaving states out never costs optimality."""

import pytest

import mala_drake.planning.dominance as mut
from mala_drake.planning import Planner, PlanningTask
from mala_drake.planning.limits import Budget
from mala_drake.planning.model import Model
from mala_drake.planning.search import best_first


def directions_of(task):
    grounding = task.grounding(task.initial_state)
    model = Model(grounding.operators, grounding.table, task.initial_state.values)
    start = (grounding.operators.mask(task.initial_state.facts), model.numbers.initial())
    names = {number: fluent for fluent, number in grounding.operators.fluents.items()}
    return {names[index]: way for index, way in grounding.resources.find(model, start).items()}


def battery_task(use="(decrease (e) 1)", needs="(>= (e) 1)", more=""):
    domain = f"""(define (domain d) (:predicates (done)) (:functions (e) (y) (c))
      (:action use :precondition {needs} :effect (and {use} (increase (c) 1)))
      (:action fill :effect (and (assign (e) 3) (increase (c) 2)))
      (:action finish :precondition (>= (e) 2) :effect (done)) {more})"""
    problem = """(define (problem p) (:domain d) (:init (= (e) 2) (= (y) 0) (= (c) 0)) (:goal (done))
      (:metric minimize (c)))"""
    return PlanningTask.parse(domain, problem)


def test_a_battery_is_better_high_and_a_load_better_low(load):
    assert directions_of(load("care")) == {("battery-soc", "robot1"): 1}
    assert directions_of(load("depots")) == {("current-load", "t"): -1}


def test_penalties_for_being_low_keep_a_resource():
    penalty = "(and (decrease (e) 1) (when (< (e) 2) (increase (c) 5)))"
    assert directions_of(battery_task(penalty)) == {("e",): 1}


@pytest.mark.parametrize(
    "options",
    [
        {"needs": "(and (>= (e) 1) (<= (e) 2))"},
        {"needs": "(= (e) 2)"},
        {"needs": "(or (done) (< (e) 2))"},
        {"use": "(and (decrease (e) 1) (when (> (e) 1) (increase (c) 5)))"},
        {"use": "(and (decrease (e) 1) (when (< (e) 2) (decrease (c) 0.5)))"},
        {"use": "(and (decrease (e) 1) (when (< (e) 2) (done)))"},
        {"use": "(decrease (e) (y))", "more": "(:action more :effect (increase (y) 1))"},
        {"use": "(scale-down (e) 2)"},
    ],
)
def test_what_may_profit_from_less_is_no_resource(options):
    assert ("e",) not in directions_of(battery_task(**options))


def test_worse_states_are_left_out_and_better_ones_kept():
    dominance = mut.ResourceDominance({0: 1}, 2)
    assert not dominance((1, (5, 7)), 10)
    assert dominance((1, (5, 7)), 11)
    assert dominance((1, (4, 7)), 10)
    assert not dominance((1, (6, 7)), 11)
    assert not dominance((1, (5, 8)), 12)  # Another value of what is no resource.
    assert not dominance((2, (1, 7)), 99)
    assert not dominance((1, (9, 7)), 1)
    assert dominance((1, (6, 7)), 10)


@pytest.mark.parametrize("battery", [0.33, 0.37, 0.45])
def test_dominance_alone_keeps_the_optimum_and_spares_expansions(load, battery):
    task = load("care")
    state = task.initial_state.with_fluents({"(battery-soc robot1)": battery})
    grounding = task.grounding(state)
    model = Model(grounding.operators, grounding.table, state.values)
    start = (grounding.operators.mask(state.facts), model.numbers.initial())
    few = Budget()
    dominance = mut.ResourceDominance(grounding.resources.find(model, start), len(start[1]))
    found = best_first(model, start, dominated=dominance, budget=few)
    plan = Planner(task).solve(state)
    assert plan.status == "optimal"
    assert model.numbers.exact(found.cost) == plan.cost
    assert few.expanded < 3000
