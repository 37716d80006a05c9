"""Best-first search is optimal with any admissible heuristic, however inconsistent."""

import random
from fractions import Fraction

import pytest

import mala_drake.planning.search as mut
from mala_drake.planning import PlanningTask
from mala_drake.planning.limits import Budget, OutOfBudget
from mala_drake.planning.model import Model
from mala_drake.planning.projection import ProjectionHeuristic


def search_space(task):
    grounding = task.grounding(task.initial_state)
    model = Model(grounding.operators, grounding.table, task.initial_state.values)
    start = (grounding.operators.mask(task.initial_state.facts), model.numbers.initial())
    assert grounding.graph.explore(start[0], Budget())
    return model, start, ProjectionHeuristic(grounding.graph, model)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("name", ["logistics", "lift", "hanoi"])
def test_an_inconsistent_heuristic_does_not_cost_optimality(load, name, seed):
    model, start, exact = search_space(load(name))
    shares = {}
    generator = random.Random(seed)

    def inconsistent(state):
        bound = exact(state)
        share = shares.setdefault(state, Fraction(generator.choice([0, 0, 1, 2, 3, 3]), 3))
        return None if bound is None else bound * share

    budget = Budget()
    found = mut.best_first(model, start, heuristic=inconsistent, budget=budget)
    assert found.cost == exact(start)


def test_a_state_reached_more_cheaply_later_is_opened_again():
    # Directly c costs 4, by way of b only 2; the bound at b, admissible and inconsistent, hides that at first.
    domain = """(define (domain d) (:predicates (a) (b) (c) (goal)) (:functions (total-cost))
      (:action ab :precondition (a) :effect (and (not (a)) (b) (increase (total-cost) 1)))
      (:action ac :precondition (a) :effect (and (not (a)) (c) (increase (total-cost) 4)))
      (:action bc :precondition (b) :effect (and (not (b)) (c) (increase (total-cost) 1)))
      (:action end :precondition (c) :effect (and (not (c)) (goal) (increase (total-cost) 5))))"""
    problem = "(define (problem p) (:domain d) (:init (a)) (:goal (goal)) (:metric minimize (total-cost)))"
    model, start, _ = search_space(PlanningTask.parse(domain, problem))
    bit = 1 << model.task.facts["b",]
    budget = Budget()
    found = mut.best_first(model, start, heuristic=lambda state: 6 if state[0] & bit else 0, budget=budget)
    assert found.cost == 7
    # a, c, b, c again: without opening c again the answer would be 9.
    assert budget.expanded == 4


def test_no_way_to_the_goal_is_known_only_when_everything_was_seen(load):
    task = load("gripper")
    stuck = task.initial_state.with_facts(remove=["(free left)", "(free right)"])
    grounding = task.grounding(task.initial_state)
    model = Model(grounding.operators, grounding.table, stuck.values)
    start = (grounding.operators.mask(stuck.facts), ())
    budget = Budget()
    assert mut.best_first(model, start, budget=budget) is None
    assert budget.expanded == 2  # In one room or the other.
    with pytest.raises(OutOfBudget):
        mut.best_first(model, start, budget=Budget(max_expansions=1))


def test_no_bound_is_computed_after_the_time_is_up(clock):
    # One expansion with a hundred successors, each bound of which takes a second.
    adders = " ".join(f"(:action a{i} :effect (p{i}))" for i in range(100))
    predicates = " ".join(f"(p{i})" for i in range(100))
    task = PlanningTask.parse(
        f"(define (domain d) (:predicates {predicates}) {adders})",
        f"(define (problem p) (:domain d) (:init) (:goal (and {predicates})))",
    )
    grounding = task.grounding(task.initial_state)
    model = Model(grounding.operators, grounding.table, task.initial_state.values)
    calls = 0

    def slow(state):
        nonlocal calls
        calls += 1
        clock.now += 1.0
        return 0

    with pytest.raises(OutOfBudget):
        mut.best_first(model, (0, ()), heuristic=slow, budget=Budget(timeout=3.5))
    assert calls == 4  # Begun at 0, 1, 2 and 3 seconds.
