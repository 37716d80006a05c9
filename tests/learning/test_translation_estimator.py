"""The learned translation: the chain rule against differences, and bounds that hold for all preferences."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mala_drake.control.parameters import CONTROL_WEIGHTS, STATE_WEIGHTS
from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION, CostTranslation
from mala_drake.errors import BadInput
from mala_drake.learning.translation_estimator import TranslationEstimator

WEIGHTS = (0.5, 0.12, 0.14, 0.14, 0.10)
WORKING_POINT = np.array((*STATE_WEIGHTS, *CONTROL_WEIGHTS))

finite = st.floats(-1e3, 1e3)
simplex = arrays(float, 5, elements=st.floats(0.001, 1.0)).map(lambda w: tuple((w / w.sum()).tolist()))
legs = st.lists(st.tuples(simplex, finite, arrays(float, 9, elements=finite)), max_size=30)


def cost(logarithms):
    """Any smooth function of the weights' logarithms that a common factor does not change."""
    return float(np.sin(np.diff(logarithms)) @ np.arange(1.0, 9.0)) / 100.0


def entries(gains):
    return np.log(np.concatenate(CostTranslation.of(gains)(WEIGHTS)))


def differences(function, at):
    steps = 1e-6 * np.eye(at.size).reshape(-1, *at.shape)
    return np.array([function(at + step) - function(at - step) for step in steps]).reshape(*at.shape, -1) / 2e-6


def test_before_any_leg_it_is_the_default_translation():
    learner = TranslationEstimator()
    assert learner.translation(learner.initial_state()) == DEFAULT_TRANSLATION
    assert learner.learned(learner.initial_state()) == ()


def test_an_update_is_a_step_down_the_mismatch_by_the_chain_rule():
    learner = TranslationEstimator(rate=0.002, trust_radius=1.0)
    before, mismatch = learner.initial_state(), 0.01
    start = learner.gains(before)
    gradient = differences(cost, entries(start))[:, 0]
    by_gains = differences(lambda gains: cost(entries(gains)), start)[:, :, 0]
    after = learner.update(before, WEIGHTS, mismatch, gradient)
    expected = start - 0.002 * mismatch * by_gains / np.sum(by_gains**2)
    np.testing.assert_allclose(learner.gains(after), expected, atol=1e-9)
    assert learner.translation(after)(WEIGHTS)[0] != pytest.approx(DEFAULT_TRANSLATION(WEIGHTS)[0], rel=1e-9)
    np.testing.assert_allclose(entries(start), np.log(WORKING_POINT) + np.log(1 + start @ (np.array(WEIGHTS) - 0.2)))


def test_the_mismatch_falls_over_the_legs_though_they_differ_in_their_preferences():
    learner = TranslationEstimator(rate=0.2)
    state, generator = learner.initial_state(), np.random.default_rng(0)
    weights = [tuple(generator.dirichlet(np.ones(5))) for _ in range(3)]
    target = [cost(np.log(np.concatenate(DEFAULT_TRANSLATION(each)))) - 0.01 for each in weights]

    def mismatches():
        translation = learner.translation(state)
        return [cost(np.log(np.concatenate(translation(w)))) - c for w, c in zip(weights, target, strict=True)]

    first = np.abs(mismatches()).sum()
    for _ in range(60):
        for i, each in enumerate(weights):
            at = np.log(np.concatenate(learner.translation(state)(each)))
            state = learner.update(state, each, mismatches()[i], differences(cost, at)[:, 0])
    assert np.abs(mismatches()).sum() < 0.1 * first


@given(legs)
def test_whatever_is_told_each_entry_stays_within_its_bounds_on_the_whole_simplex(told):
    learner = TranslationEstimator(rate=1.0, trust_radius=5.0)
    state = learner.initial_state()
    for leg in told:
        state = learner.update(state, *leg)
    translation = learner.translation(state)
    for corner in np.eye(5):  # An entry is affine in the preferences.
        factors = 1.0 + translation.gains @ (corner - 0.2)
        assert factors.min() >= translation.LOWEST - 1e-9
        assert factors.max() <= translation.HIGHEST + 1e-9
    np.testing.assert_allclose(translation.gains.mean(axis=1), DEFAULT_TRANSLATION.gains.mean(axis=1), atol=1e-9)


@pytest.mark.parametrize(
    ("weights", "mismatch", "gradient"),
    [
        ((0.2,) * 5, 0.1, np.arange(9.0)),  # Uniform preferences are the working point, whatever the gains.
        (WEIGHTS, math.nan, np.arange(9.0)),
        (WEIGHTS, 0.1, np.full(9, math.nan)),
        (WEIGHTS, 0.1, np.ones(9)),  # A common factor of all weights changes nothing.
    ],
)
def test_what_says_nothing_teaches_nothing(weights, mismatch, gradient):
    learner = TranslationEstimator()
    state = learner.initial_state()
    np.testing.assert_array_equal(learner.update(state, weights, mismatch, gradient), state)


@given(legs)
def test_a_state_comes_back_bit_for_bit(told):
    learner = TranslationEstimator()
    state = learner.initial_state()
    for leg in told:
        state = learner.update(state, *leg)
    assert learner.restore(json.loads(json.dumps(learner.save(state)))).tobytes() == state.tobytes()


def test_bad_settings_are_refused():
    for settings in ({"rate": 0.0}, {"rate": 2.0}, {"trust_radius": 0.0}):
        with pytest.raises(BadInput):
            TranslationEstimator(**settings)
    steep = CostTranslation.of(4.0 * DEFAULT_TRANSLATION.gains)
    with pytest.raises(BadInput, match="leaves its bounds"):
        TranslationEstimator(start=steep)
