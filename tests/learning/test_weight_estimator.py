"""Factors of the controller's weights: the rule by hand, its bounds, and the mismatch that it is to make fall."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mala_drake.errors import BadInput
from mala_drake.learning.weight_estimator import WeightEstimator

PLACES = ("pantry", "stove")
GRADIENT = np.array([0.1, 0.2, -0.1, 0.0, 0.05, 0.15, -0.3, 0.1, 0.2])  # By group 0.3, -0.1, 0.2, 0.0.

finite = st.floats(-1e3, 1e3)
legs = st.lists(st.tuples(st.sampled_from(PLACES), finite, arrays(float, 9, elements=finite)), max_size=30)


def test_before_any_leg_all_factors_are_one():
    learner = WeightEstimator(PLACES)
    assert learner.factors(learner.initial_state(), "stove") == (1.0,) * 4
    assert learner.learned(learner.initial_state()) == ()


def test_an_update_is_the_paper_s_rule_with_gauss_and_newton_s_rate():
    learner = WeightEstimator(PLACES, gain=0.8, trust_radius=10.0)
    state = learner.update(learner.initial_state(), "stove", 0.01, GRADIENT)
    slopes = np.array([0.3, -0.1, 0.2, 0.0]) - 0.1
    expected = -0.8 / (slopes @ slopes) * 0.01 * slopes
    np.testing.assert_allclose(np.log(learner.factors(state, "stove")), expected, atol=1e-12)
    assert learner.factors(state, "pantry") == (1.0,) * 4
    assert [place for place, _ in learner.learned(state)] == ["stove"]


def test_a_dear_leg_moves_against_the_gradient_and_a_cheap_one_along_it():
    learner = WeightEstimator(PLACES)
    dear = learner.update(learner.initial_state(), "stove", 0.01, GRADIENT)
    cheap = learner.update(learner.initial_state(), "stove", -0.01, GRADIENT)
    dear, cheap = (np.log(learner.factors(state, "stove")) for state in (dear, cheap))
    np.testing.assert_allclose(dear, -cheap, atol=1e-12)
    assert dear[0] < 0.0 < dear[1]


def visits(mismatches, **settings):
    """The logarithms that each leg was driven with, for mismatches one leg after another, and those after the last."""
    learner = WeightEstimator(PLACES, **settings)
    state, driven = learner.initial_state(), []
    for mismatch in mismatches:
        driven.append(np.log(learner.factors(state, "pantry")))
        state = learner.update(state, "pantry", mismatch, GRADIENT)
    return [*driven, np.log(learner.factors(state, "pantry"))]


def test_a_step_is_trusted_only_so_far():
    first, second, third = visits([100.0, 99.0], trust_radius=0.5, largest_factor=100.0)
    assert np.linalg.norm(second - first) == pytest.approx(0.5)
    assert np.linalg.norm(third - second) == pytest.approx(0.5)


def test_a_step_that_does_not_help_is_taken_back_and_the_next_one_is_shorter():
    first, second, third, fourth, fifth = visits([8.0, 9.0, 8.0, 7.0], trust_radius=0.5, largest_factor=99.0)
    assert np.linalg.norm(second - first) == pytest.approx(0.5)
    np.testing.assert_array_equal(third, first)
    assert np.linalg.norm(fourth - third) == pytest.approx(0.25)
    assert np.linalg.norm(fifth - fourth) == pytest.approx(0.5)  # The one before has helped.


def test_where_the_mismatch_does_not_answer_the_weights_stay_about_where_they_are():
    driven = visits([0.05] * 40, trust_radius=0.5)
    np.testing.assert_array_equal(driven[::2], np.zeros((21, 4)))
    tried = np.linalg.norm(driven[1::2], axis=1)
    assert tried[0] > 0.07
    assert (np.diff(tried) <= 0.0).all()
    assert tried[-1] == pytest.approx(0.5 / 256.0)


SLOPES = np.array([0.3, -0.1, 0.2, 0.0])
"""Of the mismatch by the logarithms, as `GRADIENT` has them."""


def answers(learner, state, legs, offset, *, steepness=1.0):
    """Mismatches that answer the weights, `steepness` times as much as the learner is told, and the state after."""
    mismatches = []
    for _ in range(legs):
        logarithms = np.log(learner.factors(state, "stove"))
        mismatches.append(offset + steepness * SLOPES @ logarithms)
        state = learner.update(state, "stove", mismatches[-1], GRADIENT)
    return np.array(mismatches), state


def test_the_mismatch_falls_even_if_the_gradient_is_several_times_too_small():
    learner = WeightEstimator(PLACES)
    mismatches, _ = answers(learner, learner.initial_state(), 15, 0.05, steepness=5.0)
    assert np.abs(mismatches[-4:]).max() < 0.1 * mismatches[0]


@pytest.mark.parametrize("past", [[1e-4, *[0.3] * 10], [0.0, *[0.3] * 10], [0.05] * 40, [0.05, 0.0, 0.05]])
def test_whatever_was_in_the_past_a_mismatch_that_answers_is_learned(past):
    learner = WeightEstimator(PLACES)
    state = learner.initial_state()
    for mismatch in past:
        state = learner.update(state, "stove", mismatch, GRADIENT)
    mismatches, _ = answers(learner, state, 15, 0.05)
    assert np.abs(mismatches[-1]) < 0.1 * 0.05


def test_a_mismatch_that_is_gone_and_reappears_is_learned_again():
    learner = WeightEstimator(PLACES)
    state = learner.initial_state()
    for offset in (0.05, -0.03, 0.08):
        mismatches, state = answers(learner, state, 25, offset)
        assert np.abs(mismatches[-1]) < 0.1 * abs(mismatches[0])


def test_weights_that_have_stood_on_their_bound_leave_it_when_the_mismatch_turns():
    learner = WeightEstimator(PLACES, largest_factor=1.2)
    mismatches, state = answers(learner, learner.initial_state(), 30, 5.0)
    assert np.log(learner.factors(state, "stove")).min() == pytest.approx(-math.log(1.2))
    assert mismatches[-1] > 4.0
    mismatches, _ = answers(learner, state, 15, 0.0)
    assert np.abs(mismatches[-1]) < 0.1 * abs(mismatches[0])


def test_a_common_factor_is_not_learned():
    learner = WeightEstimator(PLACES)
    state = learner.update(
        learner.initial_state(), "stove", 0.1, np.array([0.5, 0.5, 1.0, 0.5, 0.25, 0.25, 0.5, 0.25, 0.25])
    )
    assert learner.factors(state, "stove") == (1.0,) * 4


@given(legs)
def test_whatever_is_told_the_factors_stay_within_their_bounds_and_balanced(told):
    learner = WeightEstimator(PLACES, largest_factor=4.0)
    state = learner.initial_state()
    for place, mismatch, gradient in told:
        state = learner.update(state, place, mismatch, gradient)
        for each in PLACES:
            factors = np.array(learner.factors(state, each))
            assert factors.min() >= 0.25 * (1 - 1e-12)
            assert factors.max() <= 4.0 * (1 + 1e-12)
            assert np.log(factors).sum() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("place", "mismatch", "gradient"),
    [
        ("nowhere", 0.1, GRADIENT),
        ("stove", math.nan, GRADIENT),
        ("stove", 0.1, np.full(9, math.inf)),
        ("stove", 0.1, np.zeros(9)),
    ],
)
def test_what_says_nothing_teaches_nothing(place, mismatch, gradient):
    learner = WeightEstimator(PLACES)
    state = learner.update(learner.initial_state(), "stove", 0.01, GRADIENT)
    np.testing.assert_array_equal(learner.update(state, place, mismatch, gradient), state)


@given(legs)
def test_a_state_comes_back_bit_for_bit(told):
    learner = WeightEstimator(PLACES)
    state = learner.initial_state()
    for leg in told:
        state = learner.update(state, *leg)
    restored = learner.restore(json.loads(json.dumps(learner.save(state))))
    assert restored.tobytes() == state.tobytes()


@pytest.mark.parametrize(
    "settings", [{"gain": 0.0}, {"trust_radius": -1.0}, {"trust_radius": math.nan}, {"largest_factor": 1.0}]
)
def test_bad_settings_are_refused(settings):
    with pytest.raises(BadInput, match=next(iter(settings))):
        WeightEstimator(PLACES, **settings)
