import numpy as np

from mala_drake.learning import RandomWeights
from mala_drake.preferences import UNIFORM_WEIGHTS
from mala_drake.randomness import keyed_generator

LEARNER = RandomWeights()


def test_every_episode_has_other_weights_spread_evenly_over_the_simplex():
    state = LEARNER.initial_state()
    drawn = np.array([LEARNER.planning_weights(state, keyed_generator(0, k, "draw")) for k in range(2000)])
    np.testing.assert_allclose(drawn.sum(axis=1), 1.0)
    np.testing.assert_allclose(drawn.mean(axis=0), 0.2, atol=0.02)
    np.testing.assert_allclose(drawn.std(axis=0), np.sqrt(4.0 / 150.0), rtol=0.1)


def test_it_learns_nothing_but_counts():
    state = LEARNER.update(LEARNER.initial_state(), ratings=(1.0,) * 5, features=(0.9,) * 5)
    assert LEARNER.updates(state) == 1
    np.testing.assert_array_equal(LEARNER.estimate(state), UNIFORM_WEIGHTS)
    assert LEARNER.deviation(state) is None
