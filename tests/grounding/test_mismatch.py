import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mala_drake.grounding import (
    LocationGrounding,
    LocationMembership,
    MinimumNorms,
    ProductNorms,
    SaturatedRamp,
    best_state,
    location_error,
    location_error_gradient,
    location_mismatch,
    reach_error,
    state_mismatch,
    state_mismatch_gradient,
)

STEP = 1e-6
PANTRY = LocationMembership((-3.0, 15.0))


def test_another_place_and_no_place_are_mismatches():
    assert location_mismatch("fridge", "pantry")
    assert location_mismatch("", "pantry")
    assert not location_mismatch("pantry", "pantry")


def test_nothing_contradicts_no_expectation():
    assert not location_mismatch("fridge", "")
    assert not location_mismatch("", "")


def test_agreement_is_no_mismatch():
    assert state_mismatch([0.3, 0.6], [True, False], [True, False], norms=ProductNorms()) == 0.0


def test_certainty_of_another_state_is_full_mismatch():
    assert state_mismatch([1.0, 0.0], [True, False], [False, True], norms=ProductNorms()) == 1.0


@given(st.lists(st.floats(0.0, 1.0), min_size=3, max_size=3), st.lists(st.booleans(), min_size=3, max_size=3))
def test_the_best_state_is_never_less_true_than_the_predicted_one(values, predicted):
    everything = np.array([[a, b, c] for a in (False, True) for b in (False, True) for c in (False, True)])
    best = best_state(values, everything, norms=MinimumNorms())
    assert best is not None
    assert 0.0 <= state_mismatch(values, everything[best.index], predicted, norms=MinimumNorms()) <= 1.0


@given(st.lists(st.floats(0.01, 0.99), min_size=3, max_size=3))
def test_its_gradient_is_that_of_finite_differences(values):
    observed, predicted = [True, False, True], [False, True, True]
    values = np.array(values)
    differences = [
        (
            state_mismatch(values + step, observed, predicted, norms=ProductNorms())
            - state_mismatch(values - step, observed, predicted, norms=ProductNorms())
        )
        / (2.0 * STEP)
        for step in STEP * np.eye(3)
    ]
    gradient = state_mismatch_gradient(values, observed, predicted, norms=ProductNorms())
    np.testing.assert_allclose(gradient, differences, atol=1e-8)


def test_the_continuous_error_remains_where_the_crisp_one_is_gone():
    position = (-3.0 + 2.0, 15.0)  # Within 2.2 m the place counts as reached.
    grounding = LocationGrounding({"pantry": PANTRY.centre})
    assert not location_mismatch(grounding.place(grounding.values(position)), "pantry")
    assert location_error(PANTRY, position) == pytest.approx(0.25)
    assert location_error(PANTRY, (-3.0 + 1.0, 15.0)) == 0.0


@given(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_the_gradient_of_the_error_leads_away_from_the_place(dx, dy):
    assume(1.001 < np.hypot(dx, dy) < 4.999)
    position = np.add(PANTRY.centre, (dx, dy))
    gradient = location_error_gradient(PANTRY, position)
    differences = [
        (location_error(PANTRY, position + step) - location_error(PANTRY, position - step)) / (2.0 * STEP)
        for step in STEP * np.eye(2)
    ]
    np.testing.assert_allclose(gradient, differences, atol=1e-7)
    assert np.dot(gradient, (dx, dy)) > 0.0


@given(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0))
def test_less_is_out_of_reach_the_nearer_the_robot_comes(dx, dy):
    ramp = SaturatedRamp(full=0.0, zero=4.0)
    distance = float(np.hypot(dx, dy))
    assume(abs(distance - 4.0) > 1e-3 and distance > 1e-3)
    error, gradient = reach_error(ramp, (dx, dy))
    assert error == pytest.approx(min(distance / 4.0, 1.0))
    for axis in range(2):
        step = STEP * np.eye(2)[axis]
        # A robot that moves by `step` has so much less to go.
        later, sooner = (reach_error(ramp, tuple(np.array([dx, dy]) - sign * step))[0] for sign in (1, -1))
        assert gradient[axis] == pytest.approx((later - sooner) / (2 * STEP), abs=1e-6)


def test_within_reach_nothing_is_missing():
    assert reach_error(SaturatedRamp(full=0.0, zero=4.0), (0.0, 0.0)) == (0.0, (0.0, 0.0))
