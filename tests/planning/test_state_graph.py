import itertools
from fractions import Fraction

import numpy as np
import pytest

import mala_drake.planning.state_graph as mut
from mala_drake.errors import BadInput
from mala_drake.planning.limits import OutOfBudget


def explored_by_hand(task):
    """Breadth first with the interpreter, which knows no bit masks and no compiled numbers: states and transitions.

    Accumulators of the metric are part of these states, so it only serves tasks that have none.
    """
    seen, queue, transitions = {task.initial_state}, [task.initial_state], []
    for state in queue:
        if task.is_goal(state):
            continue
        for action in task.applicable(state):
            after = task.apply(state, action)
            transitions.append(action)
            if after not in seen:
                seen.add(after)
                queue.append(after)
    return seen, transitions


@pytest.mark.parametrize("name", ["briefcase", "gripper", "hanoi"])
def test_states_and_transitions_are_those_of_the_interpreter(load, name):
    task = load(name)
    graph = mut.explore(task)
    states, transitions = explored_by_hand(task)
    assert graph.size == len(states)
    assert sorted(graph.names[action] for action in graph.actions) == sorted(transitions)
    assert graph.goals.sum() == sum(task.is_goal(state) for state in states)
    assert graph.unit * Fraction(int(graph.costs[0])) == 1


@pytest.mark.parametrize("name", ["blocks", "delivery", "gripper", "lift", "logistics"])
def test_the_table_hangs_together(load, name):
    graph = mut.explore(load(name))
    assert np.all(np.diff(graph.starts) >= 0)
    assert set(graph.ends.tolist()) | {0} == set(range(graph.size))
    assert not np.any(graph.goals[graph.starts])
    offsets = graph.offsets
    for state in (0, graph.size // 2, graph.size - 1):
        assert np.all(graph.starts[offsets[state] : offsets[state + 1]] == state)
    assert offsets[-1] == graph.starts.size


def heavy_items(*weights):
    return {("weight", name): weight for name, weight in zip(("small", "middle", "large"), weights, strict=True)}


def test_costs_are_exact_whole_multiples_of_the_unit(load):
    """A move of the delivery task costs 3 and what is carried: here items of 1/3, 2/7 and 1/5."""
    task = load("delivery")
    fluents = heavy_items(Fraction(1, 3), Fraction(2, 7), Fraction(1, 5))
    graph = mut.explore(task, fluents=fluents)
    assert graph.costs.dtype == np.int64
    costs = {int(cost) * graph.unit for cost in graph.costs}
    loads = {sum(each) for n in range(4) for each in itertools.combinations(fluents.values(), n)}
    assert costs == {Fraction(2), *(3 + load for load in loads)}
    assert all((cost / graph.unit).denominator == 1 for cost in costs)


def test_sums_that_do_not_fit_are_left_to_pythons_integers(load):
    awkward = [1 + Fraction(1, 10**9 + n) for n in (7, 9, 21)]
    graph = mut.explore(load("delivery"), fluents=heavy_items(*awkward))
    assert graph.costs.dtype == object
    assert all(type(cost) is int for cost in graph.costs)
    assert max(int(cost) * graph.unit for cost in graph.costs) == 3 + sum(awkward)


def test_more_states_than_allowed_are_not_explored(load):
    with pytest.raises(OutOfBudget):
        mut.explore(load("blocks"), max_expansions=10)


def test_unknown_weights_are_refused(load):
    with pytest.raises(BadInput, match="no such fluent"):
        mut.explore(load("blocks"), weights={"w9": 1})
