import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.patient import PROFILES, RatingHabits, expected_ratings, rate

WEIGHTS = PROFILES["speed_oriented"]
FEATURES = (0.5, 0.2, 0.9, 0.4, 0.7)
features = st.tuples(*[st.floats(0.0, 1.0)] * 5)


def generator(seed=0):
    return np.random.default_rng(seed)


def test_without_noise_a_rating_is_the_papers_formula():
    by_hand = [5 - 4 * f * w for f, w in zip(FEATURES, WEIGHTS, strict=True)]
    np.testing.assert_allclose(expected_ratings(FEATURES, WEIGHTS), by_hand)
    assert rate(FEATURES, WEIGHTS, generator(), RatingHabits(noise=0.0)) == pytest.approx(by_hand)


def test_noise_has_the_mean_and_deviation_it_should():
    generator_ = generator()
    samples = np.array([rate(FEATURES, WEIGHTS, generator_, RatingHabits(noise=0.1)) for _ in range(4000)])
    residuals = samples - expected_ratings(FEATURES, WEIGHTS)
    np.testing.assert_allclose(residuals.mean(axis=0), 0.0, atol=4 * 0.1 / math.sqrt(4000))
    np.testing.assert_allclose(residuals.std(axis=0), 0.1, rtol=0.05)


@given(features, st.integers(0, 100))
def test_clipped_ratings_are_the_unclipped_ones_cut_to_the_scale(f, seed):
    free = rate(f, WEIGHTS, generator(seed), RatingHabits(noise=0.5))
    clipped = rate(f, WEIGHTS, generator(seed), RatingHabits(noise=0.5, clip=True))
    assert clipped == tuple(min(max(rating, 1.0), 5.0) for rating in free)


def test_unclipped_ratings_may_exceed_five():
    assert max(rate((0.0,) * 5, WEIGHTS, generator(), RatingHabits(noise=0.1))) > 5.0


@given(st.floats(0.0, 1.0), st.integers(0, 100))
def test_leaving_ratings_out_does_not_change_those_given(missing, seed):
    full = rate(FEATURES, WEIGHTS, generator(seed), RatingHabits())
    partial = rate(FEATURES, WEIGHTS, generator(seed), RatingHabits(missing=missing))
    assert all(rating in (None, whole) for rating, whole in zip(partial, full, strict=True))


def test_ratings_are_left_out_as_often_as_asked():
    generator_ = generator()
    ratings = [rate(FEATURES, WEIGHTS, generator_, RatingHabits(missing=0.3)) for _ in range(1000)]
    assert sum(rating is None for row in ratings for rating in row) / 5000 == pytest.approx(0.3, abs=0.03)
    assert rate(FEATURES, WEIGHTS, generator(), RatingHabits(missing=1.0)) == (None,) * 5


@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_a_feature_that_is_not_finite_cannot_be_rated(number):
    ratings = rate((0.5, number, 0.5, 0.5, 0.5), WEIGHTS, generator(), RatingHabits())
    assert [rating is None for rating in ratings] == [False, True, False, False, False]


@pytest.mark.parametrize("options", [{"noise": -0.1}, {"noise": math.nan}, {"missing": 1.5}, {"missing": math.nan}])
def test_habits_out_of_range_are_refused(options):
    with pytest.raises(BadInput, match=f"^patient.{next(iter(options))}: "):
        RatingHabits(**options)
