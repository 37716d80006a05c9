"""Q-learning converges to what value iteration finds."""

import numpy as np
import pytest

import mala_drake.planning.q_learning as mut
from mala_drake.errors import BadInput
from mala_drake.planning.cost_to_go import value_iteration
from mala_drake.planning.state_graph import explore


def generator():
    return np.random.default_rng(7)


@pytest.fixture(scope="module")
def graphs(load):
    return {name: explore(load(name)) for name in ("briefcase", "gripper", "hanoi", "lift")}


@pytest.mark.parametrize("name", ["briefcase", "gripper", "hanoi", "lift"])
def test_from_anywhere_every_action_value_becomes_that_of_value_iteration(graphs, name):
    graph = graphs[name]
    learned = mut.QLearning(exploration=0.5, step_limit=50).learn(
        graph, generator(), episodes=40 * graph.size, anywhere=True
    )
    exact = value_iteration(graph).action_values()
    assert learned == pytest.approx(exact)


@pytest.mark.parametrize("name", ["gripper", "hanoi"])
def test_from_the_start_alone_the_best_plan_is_found(graphs, name):
    graph = graphs[name]
    learned = mut.QLearning(exploration=0.0).learn(graph, generator(), episodes=1500)
    optimum = float(value_iteration(graph).cost())
    assert learned[: graph.offsets[1]].min() == pytest.approx(optimum)


def test_values_grow_from_below_and_never_pass_the_truth(graphs):
    graph = graphs["gripper"]
    exact = value_iteration(graph).action_values()
    learner, values, source = mut.QLearning(), None, generator()
    errors = []
    for _ in range(6):
        values = learner.learn(graph, source, episodes=40, values=values)
        assert np.all(values <= exact + 1e-9)
        errors.append(np.abs(exact - values)[np.isfinite(exact)].mean())
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < errors[0]


def test_smaller_and_smaller_steps_converge_too(graphs):
    graph = graphs["briefcase"]
    learner = mut.QLearning(exploration=1.0, step_power=0.6, step_limit=40)
    learned = learner.learn(graph, generator(), episodes=150 * graph.size, anywhere=True)
    assert learned == pytest.approx(value_iteration(graph).action_values(), rel=0.05)


def test_the_same_generator_gives_the_same_values(graphs):
    first, second = (mut.QLearning().learn(graphs["lift"], generator(), episodes=30) for _ in range(2))
    assert np.array_equal(first, second)


@pytest.mark.parametrize("options", [{"exploration": 1.5}, {"step_power": -0.1}, {"step_limit": 0}])
def test_bad_settings_are_refused(options):
    with pytest.raises(BadInput, match=next(iter(options))):
        mut.QLearning(**options)
