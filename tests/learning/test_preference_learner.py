import json

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.learning as mut
from mala_drake.errors import BadInput
from mala_drake.messages import Preferences, Ratings
from mala_drake.preferences import UNIFORM_WEIGHTS
from mala_drake.randomness import keyed_generator


def rated(sequence):
    generator = keyed_generator(0, sequence, "test")
    features = tuple(generator.uniform(0.2, 0.9, 5).tolist())
    return Ratings(sequence, tuple(generator.uniform(3.0, 5.0, 5).tolist()), features)


class Run:
    """A learner in a simulation, to which ratings can be given one after another."""

    def __init__(self, **options):
        self.system = mut.PreferenceLearner(learner=mut.ProjectedGradient(), **options)
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        self._ratings = self.system.GetInputPort("ratings").FixValue(self.context, Value(Ratings()))

    def after(self, ratings=None) -> Preferences:
        if ratings is not None:
            self._ratings.GetMutableData().set_value(ratings)
        self.simulator.AdvanceTo(self.context.get_time() + 1.0)
        return self.system.GetOutputPort("preferences").Eval(self.context)


def test_drawn_ports_are_the_real_ports(assert_port_box):
    assert_port_box(mut.PreferenceLearner(learner=mut.ProjectedGradient()))


def test_before_any_rating_it_believes_in_uniform_weights_and_explores():
    preferences = Run().after()
    assert preferences.estimate == UNIFORM_WEIGHTS
    assert preferences.deviation is None
    assert preferences.updates == 0
    assert preferences.planning != preferences.estimate
    assert sum(preferences.planning) == pytest.approx(1.0)


def test_ratings_update_the_estimate_as_the_plain_class_does():
    learner = mut.ProjectedGradient()
    state = learner.initial_state()
    run = Run()
    for sequence in (1, 2, 3):
        ratings = rated(sequence)
        state = learner.update(state, ratings=ratings.values, features=ratings.features)
        preferences = run.after(ratings)
        assert preferences.estimate == tuple(learner.estimate(state))
        assert preferences.updates == sequence


def test_ratings_are_learned_from_once_however_long_they_stand():
    run = Run()
    once = run.after(rated(1))
    assert run.after() == once
    assert run.after(Ratings(1, (1.0,) * 5, (1.0,) * 5)) == once


def test_an_unrated_episode_teaches_nothing_but_the_next_one_explores_anew():
    run = Run()
    before = run.after()
    after = run.after(Ratings(1, (None,) * 5, (0.5,) * 5))
    assert (after.estimate, after.updates) == (before.estimate, 0)
    assert after.planning != before.planning
    assert run.after(rated(2)).updates == 1


def test_planning_weights_depend_on_nothing_but_seed_episode_and_state():
    learner = mut.ProjectedGradient()
    expected = learner.planning_weights(learner.initial_state(), keyed_generator(5, 9, "preference_learner"))
    run = Run(seed=5)
    run.system.set_learner_state(run.context, learner.initial_state(), episode=9)
    assert run.after().planning == tuple(expected)


def test_a_run_restored_from_a_checkpoint_goes_on_exactly():
    whole = Run(seed=3)
    history = [whole.after(rated(sequence)) for sequence in (1, 2, 3, 4)]

    first_half = Run(seed=3)
    for sequence in (1, 2):
        first_half.after(rated(sequence))
    learner = mut.ProjectedGradient()
    checkpoint = json.dumps(learner.save(first_half.system.learner_state(first_half.context)))

    second_half = Run(seed=3)
    second_half.system.set_learner_state(second_half.context, learner.restore(json.loads(checkpoint)), episode=2)
    assert second_half.after() == history[1]
    assert [second_half.after(rated(sequence)) for sequence in (3, 4)] == history[2:]


def test_a_fresh_context_for_each_episode_gives_what_one_long_simulation_gives():
    whole = Run(seed=3)
    history = [whole.after(rated(sequence)) for sequence in (1, 2, 3)]

    state = mut.ProjectedGradient().initial_state()
    for episode in range(3):
        run = Run(seed=3)
        run.system.set_learner_state(run.context, state, episode=episode)
        if episode > 0:
            assert run.after() == history[episode - 1]
        assert run.after(rated(episode + 1)) == history[episode]
        state = run.system.learner_state(run.context)


def test_an_episode_before_the_first_one_is_refused():
    run = Run()
    with pytest.raises(BadInput, match=r"^episode: -1; expected a number >= 0"):
        run.system.set_learner_state(run.context, mut.ProjectedGradient().initial_state(), episode=-1)


def test_its_state_is_numbers():
    run = Run()
    run.after(rated(1))
    assert run.context.num_abstract_states() == 0
    assert np.all(np.isfinite(run.context.get_discrete_state_vector().value()))


def test_a_bad_seed_is_refused():
    with pytest.raises(BadInput, match="seed"):
        Run(seed=-1)
