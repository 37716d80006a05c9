import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.learning import ProjectedGradient, convergence_episode, preference_distance, project_onto_simplex
from mala_drake.patient import PROFILES, RatingHabits, expected_ratings, rate
from mala_drake.preferences import UNIFORM_WEIGHTS
from mala_drake.randomness import keyed_generator

features = st.tuples(*[st.floats(0.0, 1.0)] * 5)
ratings = st.tuples(*[st.floats(1.0, 5.0)] * 5)
simplex_points = st.lists(st.floats(0.01, 1.0), min_size=5, max_size=5).map(lambda w: tuple(np.array(w) / math.fsum(w)))
STEP = 1e-6


def loss(weights, rating, feature):
    return 0.5 * np.sum((np.array(rating) - (5.0 - 4.0 * np.array(feature) * weights)) ** 2)


@given(simplex_points, features, ratings)
def test_a_step_goes_down_the_gradient_of_the_squared_error(weights, feature, rating):
    learner = ProjectedGradient(initial_weights=weights)
    weights = np.array(weights)
    gradient = [
        (loss(weights + step, rating, feature) - loss(weights - step, rating, feature)) / (2.0 * STEP)
        for step in STEP * np.eye(5)
    ]
    stepped = learner.update(learner.initial_state(), ratings=rating, features=feature)
    expected = project_onto_simplex(weights - 0.12 * np.array(gradient))
    np.testing.assert_allclose(learner.estimate(stepped), expected, atol=1e-7)


@given(simplex_points, simplex_points, features)
def test_without_noise_no_episode_takes_it_further_from_the_truth(start, truth, feature):
    learner = ProjectedGradient(initial_weights=start)
    state = learner.update(learner.initial_state(), ratings=tuple(expected_ratings(feature, truth)), features=feature)
    assert preference_distance(learner.estimate(state), truth) <= preference_distance(start, truth) + 1e-12


def learn(profile, seed, episodes, *, noise=0.1):
    """The estimates after each of the episodes, whose features are spread as those of real plans are."""
    learner = ProjectedGradient()
    state = learner.initial_state()
    for episode in range(episodes):
        feature = keyed_generator(seed, episode, "features").uniform(0.2, 0.9, 5)
        rating = rate(feature, PROFILES[profile], keyed_generator(seed, episode, "patient"), RatingHabits(noise=noise))
        state = learner.update(state, ratings=rating, features=feature)
        yield learner.estimate(state)


@pytest.mark.parametrize("profile", PROFILES)
def test_without_noise_it_finds_the_true_weights(profile):
    *_, final = learn(profile, seed=0, episodes=200, noise=0.0)
    np.testing.assert_allclose(final, PROFILES[profile], atol=1e-6)


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("seed", range(5))
def test_with_the_papers_noise_it_converges_within_five_episodes_and_stays(profile, seed):
    distances = [preference_distance(estimate, PROFILES[profile]) for estimate in learn(profile, seed, episodes=40)]
    episode = convergence_episode(distances)
    assert episode is not None
    assert episode <= 5
    assert distances[-1] <= 0.15


def test_criteria_without_a_rating_move_only_through_the_projection():
    learner = ProjectedGradient()
    state = learner.update(learner.initial_state(), ratings=(3.0, None, 3.0, None, 3.0), features=(0.5,) * 5)
    moved = learner.estimate(state) - 0.2
    assert moved[1] == pytest.approx(moved[3])
    assert learner.updates(state) == 1


@pytest.mark.parametrize(
    ("rating", "feature"),
    [((None,) * 5, (0.5,) * 5), ((), (0.5,) * 5), ((4.0,) * 5, (math.nan,) * 5), ((math.nan,) * 5, (0.5,) * 5)],
)
def test_an_episode_nobody_rated_teaches_nothing(rating, feature):
    learner = ProjectedGradient()
    state = learner.update(learner.initial_state(), ratings=rating, features=feature)
    np.testing.assert_array_equal(state, learner.initial_state())
    assert learner.updates(state) == 0


def test_an_update_leaves_the_old_state_as_it_was():
    learner = ProjectedGradient()
    before = learner.initial_state()
    after = learner.update(before, ratings=(3.0,) * 5, features=(0.1, 0.3, 0.5, 0.7, 0.9))
    np.testing.assert_array_equal(before, learner.initial_state())
    assert not np.array_equal(after, before)


def test_it_starts_uniform_and_is_a_point_estimate():
    learner = ProjectedGradient()
    np.testing.assert_array_equal(learner.estimate(learner.initial_state()), UNIFORM_WEIGHTS)
    assert learner.deviation(learner.initial_state()) is None


@given(st.integers(0, 1000), simplex_points)
def test_planning_weights_lie_on_the_simplex(seed, weights):
    learner = ProjectedGradient(initial_weights=weights)
    planning = learner.planning_weights(learner.initial_state(), np.random.default_rng(seed))
    assert np.all(planning >= 0.0)
    assert math.fsum(planning) == pytest.approx(1.0)


@pytest.mark.parametrize(("rated_before", "deviation"), [(0, 0.15 / 1.2), (1, 0.15 / 1.4), (39, 0.15 / 9.0)])
def test_exploration_falls_as_the_paper_says(rated_before, deviation):
    learner = ProjectedGradient()
    state = np.array([*UNIFORM_WEIGHTS, rated_before])
    assert learner.exploration_deviation(state) == pytest.approx(deviation)


def test_the_noise_that_is_explored_with_has_that_deviation():
    # From the middle of the simplex and with little noise, the projection only takes the mean of the noise away.
    learner = ProjectedGradient(exploration=0.012)
    generator = np.random.default_rng(0)
    draws = np.array([learner.planning_weights(learner.initial_state(), generator) for _ in range(4000)])
    np.testing.assert_allclose(draws.std(axis=0), 0.01 * math.sqrt(4.0 / 5.0), rtol=0.05)
    np.testing.assert_allclose(draws.mean(axis=0), 0.2, atol=1e-3)


def test_without_exploration_it_plans_with_what_it_believes():
    learner = ProjectedGradient(exploration=0.0)
    planning = learner.planning_weights(learner.initial_state(), np.random.default_rng(0))
    np.testing.assert_allclose(planning, UNIFORM_WEIGHTS, atol=1e-15)


@pytest.mark.parametrize(
    ("options", "where"),
    [
        ({"step_size": -0.1}, "learner.step_size"),
        ({"exploration": math.nan}, "learner.exploration"),
        ({"exploration_decay": math.inf}, "learner.exploration_decay"),
        ({"initial_weights": (1.0,)}, "learner.initial_weights"),
    ],
)
def test_settings_out_of_range_are_refused(options, where):
    with pytest.raises(BadInput) as error:
        ProjectedGradient(**options)
    assert error.value.where == where


def test_the_reference_variant_shrinks_its_step_mixes_and_learns_a_bias():
    """One step by hand: eta / 1.15, the mean of 0.6 new and 0.4 old, and a bias of the same step."""
    learner = ProjectedGradient.reference_variant()
    feature, rating = np.full(5, 0.5), np.array([4.0, 4.8, 4.6, 4.6, 4.6])
    state = learner.update(learner.initial_state(), ratings=rating.tolist(), features=feature.tolist())
    step, error = 0.12 / 1.15, rating - (5.0 - 4.0 * 0.5 * 0.2)
    moved = project_onto_simplex(0.2 - step * 4.0 * 0.5 * error)
    np.testing.assert_allclose(learner.estimate(state), 0.6 * moved + 0.4 * 0.2)
    np.testing.assert_allclose(state[6:], step * error)


def test_the_variant_learns_the_bias_of_a_patient_who_rates_one_criterion_low():
    truth, bias = np.array(PROFILES["speed_oriented"]), np.array([0.0, -0.4, 0.0, 0.0, 0.0])
    biased, plain = ProjectedGradient.reference_variant(), ProjectedGradient()
    with_bias, without = biased.initial_state(), plain.initial_state()
    for episode in range(1000):
        feature = keyed_generator(0, episode, "features").uniform(0.2, 0.9, 5)
        rating = expected_ratings(feature, truth) + bias
        with_bias = biased.update(with_bias, ratings=rating, features=feature)
        without = plain.update(without, ratings=rating, features=feature)
    distance = preference_distance(biased.estimate(with_bias), truth)
    assert distance < 0.75 * preference_distance(plain.estimate(without), truth)
    assert -0.45 < with_bias[7] < -0.1


@pytest.mark.parametrize("mixing", [0.0, 1.2, math.nan])
def test_a_mixing_that_is_no_share_is_refused(mixing):
    with pytest.raises(BadInput, match="mixing"):
        ProjectedGradient(mixing=mixing)
