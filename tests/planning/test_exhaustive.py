import pytest

import mala_drake.planning.exhaustive as mut
from mala_drake.planning import PlanningTask
from mala_drake.planning.limits import Budget, OutOfBudget
from mala_drake.planning.model import Model
from mala_drake.planning.search import best_first


def search_space(task):
    grounding = task.grounding(task.initial_state)
    model = Model(grounding.operators, grounding.table, task.initial_state.values)
    return model, (grounding.operators.mask(task.initial_state.facts), model.numbers.initial())


@pytest.mark.parametrize("name", ["hanoi", "lift", "logistics", "zenotravel", "depots"])
def test_agrees_with_best_first_search_where_both_are_right(load, name):
    model, start = search_space(load(name))
    assert mut.exhaustive(model, start, budget=Budget()).cost == best_first(model, start, budget=Budget()).cost


def graph_task(*edges, goal):
    """A task that walks a graph given as (from, to, cost)."""
    nodes = sorted({node for edge in edges for node in edge[:2]})
    actions = "".join(
        f"(:action {a}-{b} :precondition ({a}) :effect (and (not ({a})) ({b}) (increase (cost) {cost})))"
        for a, b, cost in edges
    )
    return PlanningTask.parse(
        f"(define (domain d) (:predicates {' '.join(f'({node})' for node in nodes)}) (:functions (cost)) {actions})",
        f"(define (problem p) (:domain d) (:init (a) (= (cost) 0)) (:goal ({goal})) (:metric minimize (cost)))",
    )


def test_gains_on_the_way_are_found():
    model, start = search_space(graph_task(("a", "b", 2), ("b", "c", -5), ("a", "c", 1), ("c", "d", 1), goal="c"))
    solution = mut.exhaustive(model, start, budget=Budget())
    assert [operator.name for operator in solution.operators] == ["(a-b)", "(b-c)"]
    assert model.numbers.exact(solution.cost) == -3


def test_a_plan_goes_on_through_the_goal_if_that_pays():
    task = PlanningTask.parse(
        """(define (domain d) (:predicates (a) (b) (c)) (:functions (cost))
          (:action one :precondition (a) :effect (and (not (a)) (b) (increase (cost) 2)))
          (:action two :precondition (and (b) (not (c))) :effect (and (c) (increase (cost) -5))))""",
        "(define (problem p) (:domain d) (:init (a) (= (cost) 0)) (:goal (b)) (:metric minimize (cost)))",
    )
    model, start = search_space(task)
    solution = mut.exhaustive(model, start, budget=Budget())
    assert [operator.name for operator in solution.operators] == ["(one)", "(two)"]
    assert model.numbers.exact(solution.cost) == -3


def test_only_cycles_that_lead_to_the_goal_make_it_unbounded():
    edges = [("a", "b", 2), ("a", "x", 0), ("x", "y", -1), ("y", "x", -1)]
    model, start = search_space(graph_task(*edges, goal="b"))
    assert model.numbers.exact(mut.exhaustive(model, start, budget=Budget()).cost) == 2
    model, start = search_space(graph_task(*edges, ("y", "b", 100), goal="b"))
    with pytest.raises(mut.UnboundedError):
        mut.exhaustive(model, start, budget=Budget())


def test_cycles_that_cost_nothing_do_no_harm():
    model, start = search_space(graph_task(("a", "b", -1), ("b", "a", 1), ("b", "c", -1), goal="c"))
    assert model.numbers.exact(mut.exhaustive(model, start, budget=Budget()).cost) == -2


def test_gives_up_rather_than_guess():
    model, start = search_space(graph_task(("a", "b", -1), ("b", "c", -1), goal="b"))
    with pytest.raises(OutOfBudget):
        mut.exhaustive(model, start, budget=Budget(max_expansions=2))
