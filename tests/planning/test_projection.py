import pytest

import mala_drake.planning.projection as mut
from mala_drake.planning import Planner, PlanningTask
from mala_drake.planning.limits import Budget, OutOfBudget
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


CHAIN = 12


class Interrupting:
    """A budget whose time is up at a certain tick."""

    def __init__(self, left):
        self.left = left

    def tick(self):
        self.left -= 1
        if self.left < 0:
            raise OutOfBudget


def walk_or_jump():
    """Places in a row, a step costing 1, and a jump from the first to the last, which costs 1000."""
    domain = """(define (domain d) (:predicates (at ?x) (next ?x ?y) (far ?x ?y)) (:functions (c))
      (:action step :parameters (?x ?y) :precondition (and (at ?x) (next ?x ?y))
        :effect (and (not (at ?x)) (at ?y) (increase (c) 1)))
      (:action jump :parameters (?x ?y) :precondition (and (at ?x) (far ?x ?y))
        :effect (and (not (at ?x)) (at ?y) (increase (c) 1000))))"""
    row = " ".join(f"(next o{i} o{i + 1})" for i in range(CHAIN))
    problem = f"""(define (problem p) (:domain d) (:objects {" ".join(f"o{i}" for i in range(CHAIN + 1))})
      (:init (at o0) (far o0 o{CHAIN}) {row} (= (c) 0)) (:goal (at o{CHAIN})) (:metric minimize (c)))"""
    return PlanningTask.parse(domain, problem)


@pytest.mark.parametrize("ticks", range(CHAIN + 1))
def test_an_exploration_that_ran_out_of_time_leaves_nothing_behind(ticks):
    task = walk_or_jump()
    grounding = task.grounding(task.initial_state)
    with pytest.raises(OutOfBudget):
        grounding.graph.explore(grounding.operators.mask(task.initial_state.facts), Interrupting(ticks))
    plan = Planner(task).solve()
    assert (plan.cost, plan.expanded) == (CHAIN, Planner(walk_or_jump()).solve().expanded)


def test_what_was_explored_before_time_ran_out_stays():
    task = walk_or_jump()
    grounding = task.grounding(task.initial_state)
    last = task.initial_state.with_facts(add=[f"(at o{CHAIN - 2})"], remove=["(at o0)"])
    near, far = (grounding.operators.mask(state.facts) for state in (last, task.initial_state))
    assert grounding.graph.explore(near, Budget())
    with pytest.raises(OutOfBudget):
        grounding.graph.explore(far, Interrupting(3))
    assert grounding.graph.explore(near, Interrupting(0))
    assert Planner(task).solve(last).cost == 2
    assert Planner(task).solve().cost == CHAIN
