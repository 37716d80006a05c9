import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import mala_drake.control.weights_to_costs as mut
from mala_drake.errors import BadInput
from mala_drake.messages import LearnedWeights

UNIFORM = (0.2,) * 5
SPEED_ORIENTED = (0.50, 0.12, 0.14, 0.14, 0.10)
SAFETY_FIRST = (0.10, 0.50, 0.15, 0.15, 0.10)

simplex = arrays(float, 5, elements=st.floats(0.001, 1.0)).map(lambda v: v / v.sum())


def test_uniform_weights_give_the_working_point():
    state_weights, control_weights = mut.DEFAULT_TRANSLATION(UNIFORM)
    np.testing.assert_allclose(state_weights, [34.0, 34.0, 3.0, 10.4, 10.4, 10.4])
    np.testing.assert_allclose(control_weights, [3.05, 3.05, 2.35])


@given(first=simplex, second=simplex, share=st.floats(0, 1))
def test_costs_are_affine_in_the_weights(first, second, share):
    mixed = np.concatenate(mut.DEFAULT_TRANSLATION(share * first + (1 - share) * second))
    ends = [np.concatenate(mut.DEFAULT_TRANSLATION(w)) for w in (first, second)]
    np.testing.assert_allclose(mixed, share * ends[0] + (1 - share) * ends[1], rtol=1e-10)


@given(weights=simplex)
def test_costs_stay_positive_and_bounded_on_the_whole_simplex(weights):
    working_point = np.concatenate(mut.DEFAULT_TRANSLATION(UNIFORM))
    ratio = np.concatenate(mut.DEFAULT_TRANSLATION(weights)) / working_point
    assert (ratio > mut.CostTranslation.LOWEST).all()
    assert (ratio < mut.CostTranslation.HIGHEST).all()


@pytest.mark.parametrize(
    ("feature", "served"),
    [("time", {0, 1}), ("approach", {2}), ("safety", {3, 4, 5}), ("proximity", {3, 4, 5}), ("battery", {6, 7, 8})],
)
def test_each_preference_raises_the_entries_that_serve_it_and_no_other(feature, served):
    i = mut.FEATURES.index(feature)
    gains = np.array([*mut.DEFAULT_TRANSLATION.state_gains, *mut.DEFAULT_TRANSLATION.control_gains])
    assert set(np.flatnonzero(gains[:, i] > 0)) == served
    assert not (gains[:, i] < 0).any()


def test_two_profiles_get_different_costs():
    fast, safe = (np.concatenate(mut.DEFAULT_TRANSLATION(w)) for w in (SPEED_ORIENTED, SAFETY_FIRST))
    assert fast[0] > 1.3 * safe[0]
    assert safe[3] > 1.3 * fast[3]


def test_all_gains_make_the_same_translation():
    assert mut.CostTranslation.of(mut.DEFAULT_TRANSLATION.gains) == mut.DEFAULT_TRANSLATION
    assert mut.learned_translation(LearnedWeights()) == mut.DEFAULT_TRANSLATION
    gains = 0.5 * mut.DEFAULT_TRANSLATION.gains
    assert mut.learned_translation(LearnedWeights(gains=tuple(map(tuple, gains)))) == mut.CostTranslation.of(gains)


@given(weights=simplex, gains=arrays(float, (9, 5), elements=st.floats(-8.0, 8.0)))
def test_the_derivative_by_the_gains_is_a_difference(weights, gains):
    factors = 1.0 + gains @ (weights - 0.2)
    assume(np.abs(np.subtract.outer(factors, [0.1, 4.0])).min() > 1e-3)  # At a bound there is a kink.
    gradient = mut.CostTranslation.of(gains).log_gradient(weights)
    for i in range(5):
        step = 1e-6 * np.eye(5)[i]  # Each row has an entry of its own.
        ends = [np.log(np.concatenate(mut.CostTranslation.of(gains + sign * step)(weights))) for sign in (1, -1)]
        np.testing.assert_allclose(gradient[:, i], (ends[0] - ends[1]) / 2e-6, atol=1e-5)


@given(gains=arrays(float, (9, 5), elements=st.floats(-1e6, 1e6)), weights=simplex)
def test_learned_gains_of_any_size_cannot_leave_the_bounds(gains, weights):
    translation = mut.CostTranslation(tuple(map(tuple, gains[:6])), tuple(map(tuple, gains[6:])))
    ratio = np.concatenate(translation(weights)) / np.concatenate(mut.DEFAULT_TRANSLATION(UNIFORM))
    assert (ratio >= 0.1 - 1e-12).all()
    assert (ratio <= 4.0 + 1e-12).all()


@pytest.mark.parametrize(
    "weights", [(0.5,) * 5, (0.2,) * 4, (np.nan, 0.25, 0.25, 0.25, 0.25), (-0.2, 0.4, 0.4, 0.2, 0.2)]
)
def test_weights_off_the_simplex_are_refused(weights):
    with pytest.raises(BadInput, match="sum to one"):
        mut.DEFAULT_TRANSLATION(weights)


def test_gains_of_the_wrong_shape_are_refused():
    with pytest.raises(BadInput, match="state_gains"):
        mut.CostTranslation(state_gains=((1.0,) * 5,))
