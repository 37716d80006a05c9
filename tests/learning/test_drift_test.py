import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from mala_drake.learning.drift_test import ALARM, Prediction, conspicuousness, standard_normal_of_f
from mala_drake.learning.rating_evidence import Observation

WEIGHTS = np.array([0.5, 0.12, 0.14, 0.14, 0.1])
PREDICTION = Prediction(WEIGHTS, np.full(5, 0.01**2), 0.025, 40.0)


def episodes(count, weights, *, seed=0):
    generator = np.random.Generator(np.random.PCG64(seed))
    features = generator.uniform(0.2, 0.9, (count, 5))
    ratings = 5.0 - 4.0 * features * weights + 0.1 * generator.standard_normal((count, 5))
    return [Observation(f, r) for f, r in zip(features, ratings, strict=True)]


@given(st.floats(0.3, 8.0), st.sampled_from([1, 3, 5]), st.integers(14, 200))
def test_the_normal_number_has_the_probability_of_the_f_statistic(statistic, numerator, denominator):
    number = standard_normal_of_f(statistic, numerator, denominator)
    exact = stats.norm.isf(stats.f.sf(statistic, numerator, denominator))
    assert number == pytest.approx(exact, abs=0.12)


def test_episodes_of_the_same_patient_raise_no_alarm():
    found = [conspicuousness(episodes(4, WEIGHTS, seed=seed), PREDICTION) for seed in range(300)]
    assert max(found) < ALARM
    assert np.mean(found) < 0.5


def test_a_changed_patient_is_seen_in_three_episodes():
    changed = np.array([0.1, 0.5, 0.15, 0.15, 0.1])
    assert all(conspicuousness(episodes(3, changed, seed=seed), PREDICTION) > ALARM for seed in range(50))


def test_one_strange_episode_is_no_change():
    window = episodes(4, WEIGHTS)
    window[2] = Observation(window[2].features, np.full(5, 1.3))
    assert conspicuousness(window, PREDICTION) < ALARM


def test_one_wild_rating_twice_is_no_change():
    window = episodes(6, WEIGHTS)
    for i, criterion in ((1, 0), (4, 3)):
        ratings = window[i].ratings.copy()
        ratings[criterion] = 1.5
        window[i] = Observation(window[i].features, ratings)
    assert conspicuousness(window, PREDICTION) < ALARM


def test_while_the_noise_is_unknown_nothing_is_said():
    unsure = Prediction(WEIGHTS, np.full(5, 1e-4), 0.025, 5.0)
    assert conspicuousness(episodes(3, WEIGHTS[::-1]), unsure) == -math.inf
    assert conspicuousness(episodes(1, WEIGHTS[::-1]), PREDICTION) == -math.inf


def test_what_may_have_been_cut_says_nothing():
    cut = [Observation(np.full(5, 0.5), np.full(5, 5.0))] * 3
    assert conspicuousness(cut, PREDICTION) == -math.inf
