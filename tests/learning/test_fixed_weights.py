import numpy as np
import pytest

from mala_drake.errors import BadInput
from mala_drake.learning import FixedWeights, PreferenceLearner

WEIGHTS = (0.4, 0.3, 0.1, 0.1, 0.1)


def test_ratings_change_nothing_but_the_count():
    learner = FixedWeights(weights=WEIGHTS)
    state = learner.update(learner.initial_state(), ratings=(1.0,) * 5, features=(0.9,) * 5)
    state = learner.update(state, ratings=(None,) * 5, features=(0.9,) * 5)
    assert learner.updates(state) == 1
    np.testing.assert_array_equal(learner.estimate(state), WEIGHTS)
    np.testing.assert_array_equal(learner.planning_weights(state, np.random.default_rng(0)), WEIGHTS)


def test_it_takes_the_place_of_any_learner_in_the_diagram():
    system = PreferenceLearner(learner=FixedWeights(weights=WEIGHTS))
    preferences = system.GetOutputPort("preferences").Eval(system.CreateDefaultContext())
    assert preferences.planning == preferences.estimate == WEIGHTS
    assert preferences.deviation is None


def test_weights_off_the_simplex_are_refused():
    with pytest.raises(BadInput, match=r"^learner\.weights: the sum"):
        FixedWeights(weights=(0.4,) * 5)
