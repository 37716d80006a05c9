import numpy as np
import pytest

from mala_drake.errors import BadInput
from mala_drake.learning import Bandit
from mala_drake.patient import PROFILES
from mala_drake.preferences import UNIFORM_WEIGHTS
from mala_drake.randomness import keyed_generator

LEARNER = Bandit()
GENERATOR = keyed_generator(0, 0, "unused")


def test_its_arms_are_on_the_simplex_and_all_are_tried_first():
    state, tried = LEARNER.initial_state(), []
    for _ in range(6):
        weights = LEARNER.planning_weights(state, GENERATOR)
        assert weights.sum() == pytest.approx(1.0)
        tried.append(tuple(weights))
        state = LEARNER.update(state, ratings=(4.0,) * 5, features=(0.5,) * 5)
    assert len(set(tried)) == 6
    assert LEARNER.updates(state) == 6


def test_it_settles_on_the_arm_that_is_rated_best():
    """The reward of an arm is higher, the nearer its weights are to the patient's; noise as in the paper."""
    truth = np.array(PROFILES["speed_oriented"])
    state, generator, played = LEARNER.initial_state(), keyed_generator(1, 0, "patient"), []
    for _ in range(400):
        weights = LEARNER.planning_weights(state, GENERATOR)
        played.append(tuple(weights))
        distance = np.linalg.norm(weights - truth)
        ratings = 5.0 - 4.0 * distance + 0.1 * generator.standard_normal(5)
        state = LEARNER.update(state, ratings=ratings.tolist(), features=(0.5,) * 5)
    best = tuple(LEARNER.estimate(state))
    assert np.argmax(best) == truth.argmax()
    early, late = (sum(weights == best for weights in part) for part in (played[:100], played[-100:]))
    assert early < 50
    assert late > 70
    assert len(set(played[-100:])) == 6  # None is given up.


def test_no_rating_moves_the_weights_themselves():
    state = LEARNER.update(LEARNER.initial_state(), ratings=(1.0, 2.0, 3.0, 4.0, 5.0), features=(0.9,) * 5)
    np.testing.assert_array_equal(LEARNER.estimate(state), UNIFORM_WEIGHTS)  # The first arm, as it was.
    assert LEARNER.deviation(state) is None


def test_an_unrated_episode_credits_nobody_and_the_same_arm_is_next():
    before = LEARNER.update(LEARNER.initial_state(), ratings=(4.0,) * 5, features=(0.5,) * 5)
    after = LEARNER.update(before, ratings=(None,) * 5, features=(0.5,) * 5)
    np.testing.assert_array_equal(after, before)
    assert LEARNER.arm(after) == 1


@pytest.mark.parametrize("emphasis", [0.2, 1.1, float("nan")])
def test_an_emphasis_that_is_none_is_refused(emphasis):
    with pytest.raises(BadInput, match="emphasis"):
        Bandit(emphasis=emphasis)
