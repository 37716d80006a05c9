import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.learning import Posterior, convergence_episode, efficiency, preference_distance, weight_bound
from mala_drake.patient import PROFILES, RatingHabits, rate
from mala_drake.preferences import UNIFORM_WEIGHTS
from mala_drake.randomness import keyed_generator

LEARNER = Posterior()
features = st.tuples(*[st.floats(0.0, 1.0)] * 5)
ratings = st.tuples(*[st.one_of(st.none(), st.floats(0.5, 5.5), st.sampled_from([1.0, 5.0]))] * 5)
episodes = st.lists(st.tuples(features, ratings), max_size=12)


def learned(history, learner=LEARNER):
    state = learner.initial_state()
    for feature, rating in history:
        state = learner.update(state, ratings=rating, features=feature)
    return state


def simulate(truth, seed, episodes=40, *, low=0.25, high=0.9, noise=0.1, clip=False, missing=0.0, learner=LEARNER):
    """Yields the features and the state after each episode; `truth` is one weight vector or one an episode."""
    habits = RatingHabits(noise=noise, clip=clip, missing=missing)
    state = learner.initial_state()
    for episode in range(episodes):
        feature = keyed_generator(seed, episode, "features").uniform(low, high, 5)
        weights = truth(episode) if callable(truth) else truth
        rating = rate(feature, weights, keyed_generator(seed, episode, "patient"), habits)
        state = learner.update(state, ratings=rating, features=feature)
        yield feature, state


@settings(deadline=None, max_examples=40)
@given(episodes)
def test_whatever_was_rated_the_state_is_finite_and_the_weights_are_on_the_simplex(history):
    state = learned(history)
    assert np.isfinite(state).all()
    assert LEARNER.updates(state) == sum(any(r is not None for r in rating) for _, rating in history)
    for weights in (LEARNER.estimate(state), LEARNER.planning_weights(state, keyed_generator(0, 0, "draw"))):
        assert weights.sum() == pytest.approx(1.0)
        assert (weights >= 0.0).all()
    assert (LEARNER.deviation(state) > 0.0).all()


@settings(deadline=None, max_examples=30)
@given(episodes, st.integers(0, 12))
def test_a_checkpoint_goes_on_bit_for_bit(history, cut):
    state = learned(history[:cut])
    state = LEARNER.restore(json.loads(json.dumps(LEARNER.save(state))))
    for feature, rating in history[cut:]:
        state = LEARNER.update(state, ratings=rating, features=feature)
    assert state.tobytes() == learned(history).tobytes()


@settings(deadline=None, max_examples=15)
@given(episodes.filter(bool), st.permutations(range(5)))
def test_no_criterion_is_special(history, order):
    """Renaming the criteria renames the weights; what is left is the error of the fixed sampling points."""
    renamed = [(tuple(f[i] for i in order), tuple(r[i] for i in order)) for f, r in history]
    state, other = learned(history), learned(renamed)
    deviation = LEARNER.deviation(state)[list(order)]
    difference = np.abs(LEARNER.estimate(state)[list(order)] - LEARNER.estimate(other))
    assert (difference <= 0.25 * deviation + 1e-9).all()


def test_before_any_rating_it_knows_nothing():
    state = LEARNER.initial_state()
    np.testing.assert_allclose(LEARNER.estimate(state), UNIFORM_WEIGHTS, atol=0.01)
    assert (LEARNER.deviation(state) > 0.15).all()
    unrated = LEARNER.update(state, ratings=(None,) * 5, features=(0.5,) * 5)
    assert unrated.tobytes() == state.tobytes()


def test_it_finds_every_profile_as_precisely_as_can_be():
    errors, bounds = [], []
    for profile, weights in PROFILES.items():
        finals = []
        for seed in range(5):
            run = list(simulate(weights, seed))
            distances = [preference_distance(LEARNER.estimate(state), weights) for _, state in run]
            final = LEARNER.estimate(run[-1][1])
            assert convergence_episode(distances) <= 2
            assert final.argmax() == np.argmax(weights), profile
            errors.append(final - weights)
            bounds.append(weight_bound([feature for feature, _ in run], 0.1))
            finals.append(distances[-1])
        assert np.median(finals) <= 0.03, profile
    assert efficiency(errors, bounds) <= 1.15


def coverage(patients, *, checkpoints=(1, 3, 10, 40), seed=0, **habits):
    """Share of weights inside their 90 % interval after so many episodes; patients are drawn from the prior."""
    inside = {checkpoint: [] for checkpoint in checkpoints}
    for patient in range(patients):
        generator = keyed_generator(seed, patient, "coverage")
        truth = generator.dirichlet(np.ones(5))
        noise = math.exp(generator.uniform(math.log(0.05), math.log(0.2)))
        high = np.full(5, 0.9)
        high[generator.integers(5)] = generator.choice([0.9, 0.25])  # Often one feature is always small.
        run = simulate(truth, patient, max(checkpoints), low=0.2, high=high, noise=noise, **habits)
        for episode, (_, state) in enumerate(run, start=1):
            if episode in inside:
                lower, upper = LEARNER.interval(state, 0.9).T
                inside[episode].append(np.mean((lower <= truth) & (truth <= upper)))
    return {episode: float(np.mean(shares)) for episode, shares in inside.items()}


def test_intervals_cover_as_often_as_they_say():
    for share in coverage(60, checkpoints=(1, 4, 15)).values():
        assert 0.85 <= share <= 0.95


@pytest.mark.slow
@pytest.mark.parametrize("habits", [{}, {"clip": True}, {"missing": 0.3}], ids=["plain", "clipped", "missing"])
def test_intervals_of_many_patients_cover_as_often_as_they_say(habits):
    for share in coverage(500, seed=1, **habits).values():
        assert 0.85 <= share <= 0.95


def test_a_feature_near_zero_leaves_its_weight_uncertain():
    *_, (_, state) = simulate(
        PROFILES["speed_oriented"], 0, low=[0.3, 0.3, 0.3, 0.0, 0.0], high=[0.9, 0.9, 0.9, 0.01, 0.01]
    )
    deviation = LEARNER.deviation(state)
    assert (deviation[:3] < 0.01).all()
    assert (deviation[3:] > 0.05).all()  # Two unseen weights share what the seen ones leave: only their sum is known.
    lower, upper = LEARNER.interval(state, 0.9)[3]
    assert upper - lower > 0.15


def test_cut_ratings_do_not_bias_it():
    """A patient who clips: the paper's gradient learns too small weights for what is nearly always rated 5."""
    truth = np.array(PROFILES["presentation_focused"])
    finals = [LEARNER.estimate(list(simulate(truth, seed, clip=True, low=0.1, high=0.5))[-1][1]) for seed in range(8)]
    mean = np.mean(finals, axis=0)
    np.testing.assert_allclose(mean, truth, atol=0.012)


def test_the_noise_level_is_learned():
    for noise in (0.05, 0.2, 0.4):
        *_, (_, state) = simulate(PROFILES["comfort_focused"], 0, noise=noise)
        assert LEARNER.noise(state) == pytest.approx(noise, rel=0.15)


@pytest.mark.parametrize(
    ("truth", "low", "high", "noise"),
    [
        (PROFILES["presentation_focused"], 0.1, 0.5, 0.1),
        (PROFILES["speed_oriented"], 0.05, 0.3, 0.1),
        (PROFILES["speed_oriented"], 0.2, 0.9, 0.4),
        ((1.0, 0.0, 0.0, 0.0, 0.0), 0.2, 0.9, 0.1),
        ((0.5, 0.5, 0.0, 0.0, 0.0), 0.2, 0.9, 0.1),
    ],
)
def test_the_noise_level_is_learned_of_a_patient_who_clips(truth, low, high, noise):
    levels = [
        LEARNER.noise(list(simulate(truth, seed, low=low, high=high, noise=noise, clip=True))[-1][1])
        for seed in range(4)
    ]
    assert np.mean(levels) == pytest.approx(noise, rel=0.12)


def test_ratings_without_any_noise_are_learned_from_in_a_corner():
    """Four of five ratings are exactly the best one, which might have been cut."""
    truth = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    *_, (_, state) = simulate(truth, 0, noise=0.0)
    assert preference_distance(LEARNER.estimate(state), truth) < 0.02
    assert LEARNER.noise(state) < 0.15


def test_a_rating_that_was_cut_beyond_belief_does_little_harm():
    truth = PROFILES["speed_oriented"]
    *_, (_, state) = simulate(truth, 3, low=0.8, high=0.9)
    odd = LEARNER.update(state, ratings=(5.0, None, None, None, None), features=(0.9,) * 5)
    assert preference_distance(LEARNER.estimate(odd), LEARNER.estimate(state)) < 0.02


def test_a_patient_who_changes_is_learned_again():
    before, after = PROFILES["speed_oriented"], PROFILES["safety_first"]
    for seed in range(5):
        states = [state for _, state in simulate(lambda episode: before if episode < 20 else after, seed)]
        assert preference_distance(LEARNER.estimate(states[19]), before) < 0.05
        assert preference_distance(LEARNER.estimate(states[24]), after) < 0.15
        assert preference_distance(LEARNER.estimate(states[-1]), after) < 0.05


def test_a_patient_who_stays_the_same_is_never_forgotten():
    """Over stationary runs the precision is that of all episodes, which a single false alarm would halve."""
    for seed in range(40):
        *_, (_, state) = simulate(PROFILES["energy_conscious"], 100 + seed, low=0.5, high=0.50001)
        bound = weight_bound(np.full((40, 5), 0.5), LEARNER.noise(state))
        np.testing.assert_allclose(LEARNER.deviation(state), bound, rtol=0.15)


def test_wild_ratings_do_little_harm():
    truth = PROFILES["speed_oriented"]
    state = LEARNER.initial_state()
    for episode in range(40):
        feature = keyed_generator(7, episode, "features").uniform(0.25, 0.9, 5)
        rating = list(rate(feature, truth, keyed_generator(7, episode, "patient"), RatingHabits()))
        if episode % 10 == 5:
            rating[episode % 5] = 1.2
        state = LEARNER.update(state, ratings=rating, features=feature)
    assert preference_distance(LEARNER.estimate(state), truth) < 0.04


def test_it_explores_while_it_is_unsure_and_then_no_more():
    states = [state for _, state in simulate(PROFILES["safety_first"], 3)]
    spreads = []
    for state in (LEARNER.initial_state(), states[0], states[-1]):
        drawn = [LEARNER.planning_weights(state, keyed_generator(0, k, "draw")) for k in range(50)]
        spreads.append(np.ptp(drawn, axis=0).max())
    assert spreads[0] > 0.1
    assert spreads[0] > spreads[1] > 0.01
    assert spreads[2] == 0.0
    calm = Posterior(exploration_until=1.0)
    np.testing.assert_array_equal(calm.planning_weights(states[0], keyed_generator(0, 0, "")), calm.estimate(states[0]))


@pytest.mark.parametrize("setting", ["typical_noise", "noise_confidence", "exploration_until"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_settings_out_of_range_are_refused(setting, value):
    with pytest.raises(BadInput, match=setting):
        Posterior(**{setting: value})
