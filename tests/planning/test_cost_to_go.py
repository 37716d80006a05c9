"""Value iteration, the planner and Dijkstra's algorithm of another library agree exactly."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

import mala_drake.planning.cost_to_go as mut
from mala_drake.patient.profiles import PROFILES
from mala_drake.planning import Planner, validate_plan
from mala_drake.planning.care_tasks import TASK_NAMES, CareTask
from mala_drake.planning.state_graph import StateGraph, explore
from mala_drake.ward.cost_parameters import CHARGE_NAMES
from mala_drake.ward.ward_map import LoadWard

SMALL = ("blocks", "briefcase", "delivery", "gripper", "hanoi", "lift", "logistics")


def graph_of(edges, goals, *, unit=1):
    """A graph from (start, end, cost) triples."""
    starts, ends, costs = np.array(sorted(edges), dtype=np.int64).reshape(-1, 3).T
    actions = np.arange(starts.size)
    names = tuple(f"(a{i})" for i in range(starts.size))
    return StateGraph(starts, ends, costs, actions, names, np.array(goals, dtype=bool), Fraction(unit))


def by_dijkstra(graph):
    """Costs to go in the graph's unit by scipy, from all goals backwards; all costs must be positive."""
    n = graph.size
    best = {}
    for start, end, cost in zip(graph.starts.tolist(), graph.ends.tolist(), graph.costs.tolist(), strict=True):
        best[end, start] = min(cost, best.get((end, start), np.inf))
    ends, starts = np.array(list(best)).T
    matrix = csr_array((np.array(list(best.values())), (ends, starts)), shape=(n, n))
    return dijkstra(matrix, indices=np.flatnonzero(graph.goals), min_only=True)


def coarse(task, steps):
    """Charges rounded up to so many steps of a full battery: the same task in fewer states."""
    values = task.initial_state.values.items()
    kept = {*CHARGE_NAMES, "nearest-charger-battery"}
    return {name: Fraction(math.ceil(value * steps), steps) for name, value in values if name[0] in kept}


@pytest.mark.parametrize("name", SMALL)
def test_small_tasks_cost_what_the_planner_says(load, name):
    task = load(name)
    solution = mut.value_iteration(explore(task, max_expansions=50_000))
    plan = Planner(task).solve()
    before = task.metric_value(task.initial_state) if task.description.metric is not None else 0
    assert solution.cost() + before == plan.cost
    verdict = validate_plan(task, solution.plan())
    assert verdict.valid
    assert verdict.cost == plan.cost


def test_it_is_exact_where_sums_do_not_fit_into_machine_words(load):
    weights = {("weight", "small"): 1 + Fraction(1, 10**9 + 7), ("weight", "middle"): 1 + Fraction(1, 10**9 + 9)}
    graph = explore(load("delivery"), fluents=weights)
    assert graph.costs.dtype == object
    assert mut.value_iteration(graph).cost() == Planner(load("delivery")).solve(fluents=weights).cost


@pytest.mark.parametrize("name", TASK_NAMES)
@pytest.mark.parametrize("profile", ["speed_oriented", "presentation_focused"])
def test_care_tasks_cost_what_the_planner_says(name, profile):
    """Rounds and meals with recharging and low batteries, charges in steps of 2 %: 8000 to 14 000 states."""
    task = CareTask(name, LoadWard()).planning_task
    fluents = coarse(task, 50)
    graph = explore(task, weights=PROFILES[profile], fluents=fluents)
    solution = mut.value_iteration(graph)
    plan = Planner(task).solve(weights=PROFILES[profile], fluents=fluents)
    assert graph.size > 5000
    assert plan.found
    assert solution.cost() == plan.cost
    verdict = validate_plan(
        task, solution.plan(), state=task.with_weights(task.initial_state, PROFILES[profile], fluents)
    )
    assert (verdict.valid, verdict.cost) == (True, plan.cost)
    assert solution.values[solution.solvable].astype(float) == pytest.approx(by_dijkstra(graph)[solution.solvable])


@pytest.mark.slow
@pytest.mark.parametrize("name", TASK_NAMES)
@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_care_tasks_in_finer_steps_cost_what_the_planner_says(name, profile):
    task = CareTask(name, LoadWard()).planning_task
    fluents = coarse(task, 400)
    solution = mut.value_iteration(explore(task, weights=PROFILES[profile], fluents=fluents))
    assert solution.cost() == Planner(task).solve(weights=PROFILES[profile], fluents=fluents).cost


@pytest.mark.slow
@pytest.mark.parametrize(("name", "fewest_states"), [("meal", 300_000), ("medication", 1_000_000)])
def test_care_tasks_as_they_are_cost_what_the_planner_says(name, fewest_states):
    """Every state that can be reached with exact charges."""
    task = CareTask(name, LoadWard()).planning_task
    weights = (0.3, 0.1, 0.25, 0.15, 0.2)
    graph = explore(task, weights=weights, max_expansions=3_000_000)
    assert graph.size > fewest_states
    assert mut.value_iteration(graph).cost() == Planner(task).solve(weights=weights).cost


def test_the_planner_is_optimal_from_every_state_not_only_the_first():
    """The values of all states along an optimal plan are those of plans that start there."""
    task = CareTask("medication", LoadWard()).planning_task
    fluents, weights = coarse(task, 20), PROFILES["energy_conscious"]
    graph = explore(task, weights=weights, fluents=fluents)
    solution, planner = mut.value_iteration(graph), Planner(task)
    here, state = 0, task.with_weights(task.initial_state, weights, fluents)
    for action in solution.plan():
        known = {graph.names[graph.actions[i]]: i for i in range(*graph.offsets[here : here + 2])}
        here, state = int(graph.ends[known[action]]), task.apply(state, action)
        rest = planner.solve(state)
        assert solution.cost(here) == rest.cost - task.metric_value(state)


def random_graphs():
    node = st.integers(0, 7)
    return st.lists(st.tuples(node, node, st.integers(0, 20)), min_size=1, max_size=25)


@settings(max_examples=40)
@given(random_graphs(), st.sets(st.integers(0, 7), max_size=3))
def test_values_are_those_of_dijkstra_and_keep_the_bellman_equation(edges, goals):
    edges = [(a, b, 21 * c + 1) for a, b, c in edges if a not in goals]
    if not edges:
        return
    graph = graph_of(edges, [i in goals for i in range(8)])
    solution = mut.value_iteration(graph)
    if goals:
        expected = by_dijkstra(graph)
        assert np.array_equal(solution.solvable, np.isfinite(expected))
        assert np.array_equal(solution.values[solution.solvable], expected[solution.solvable])
    else:
        assert not solution.solvable.any()
    for state in range(8):
        own = solution.action_values()[graph.offsets[state] : graph.offsets[state + 1]]
        if solution.solvable[state] and state not in goals:
            assert solution.cost(state) == own.min()
        elif state not in goals:
            assert np.all(np.isinf(own))


def test_it_takes_as_many_sweeps_as_the_longest_optimal_plan_and_one_more():
    chain = graph_of([(i, i + 1, 2) for i in range(6)], [False] * 6 + [True])
    solution = mut.value_iteration(chain)
    assert solution.sweeps == 7
    assert solution.cost() == 12
    assert len(solution.plan()) == 6


def test_states_without_a_way_to_the_goal_have_no_cost_and_no_plan():
    graph = graph_of([(0, 1, 1), (0, 2, 1), (2, 2, 0)], [False, True, False])
    solution = mut.value_iteration(graph)
    assert solution.cost(2) is None
    assert solution.plan() == ("(a0)",)
    with pytest.raises(ValueError, match="no goal can be reached from state 2"):
        solution.plan(2)


def test_a_start_that_is_a_goal_costs_nothing():
    graph = graph_of([], [True])
    assert mut.value_iteration(graph).cost() == 0
    assert mut.value_iteration(graph).plan() == ()


def test_negative_costs_are_refused():
    with pytest.raises(ValueError, match="a cost is negative"):
        mut.value_iteration(graph_of([(0, 1, -1)], [False, True]))
