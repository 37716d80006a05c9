"""What every membership function has in common, whichever it is."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.grounding import Gaussian, SaturatedRamp, Sigmoid, Trapezoidal, Triangular, TruncatedAnnulus

numbers = st.floats(-20.0, 20.0)
gaps = st.floats(0.01, 10.0)
arguments = st.floats(0.0, 30.0)  # Distances: the annulus is defined for these only.
STEP = 1e-6


@st.composite
def memberships(draw):
    """A membership function of any family, with the arguments of its kinks and jumps."""
    start, a, b, c = draw(numbers), draw(gaps), draw(gaps), draw(gaps)
    family = draw(st.sampled_from(["ramp", "annulus", "triangular", "trapezoidal", "gaussian", "sigmoid"]))
    if family == "ramp":
        return SaturatedRamp(start, start + a), [start, start + a]
    if family == "annulus":
        return TruncatedAnnulus(a, a + b, width=max(c, 0.5)), [np.sqrt(a), np.sqrt(a + b)]
    if family == "triangular":
        return Triangular(start, start + a, start + a + b), [start, start + a, start + a + b]
    if family == "trapezoidal":
        kinks = [start, start + a, start + a + b, start + a + b + c]
        return Trapezoidal(*kinks), kinks
    if family == "gaussian":
        return Gaussian(start, max(a, 0.1)), []
    return Sigmoid(start, draw(st.sampled_from([-1.0, 1.0])) * a), []


@given(memberships(), arguments)
def test_a_membership_is_a_degree_of_truth(membership, x):
    mu, _ = membership
    assert 0.0 <= mu.value(x) <= 1.0
    assert mu(x) == mu.value(x)


@given(memberships(), arguments)
def test_the_derivative_is_that_of_finite_differences_away_from_kinks(membership, x):
    mu, kinks = membership
    assume(all(abs(x - kink) > 10 * STEP for kink in kinks))
    difference = (mu.value(x + STEP) - mu.value(x - STEP)) / (2.0 * STEP)
    np.testing.assert_allclose(mu.derivative(x), difference, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize(
    ("membership", "kinks"),
    [
        (SaturatedRamp(), [1.0, 5.0]),
        (TruncatedAnnulus(), [1.0]),  # The outer rim is a jump, which no difference quotient survives.
        (Triangular(1.0, 2.0, 4.0), [1.0, 2.0, 4.0]),
        (Trapezoidal(1.0, 2.0, 3.0, 5.0), [1.0, 2.0, 3.0, 5.0]),
    ],
)
def test_the_derivative_at_a_kink_looks_towards_larger_arguments(membership, kinks):
    for kink in kinks:
        difference = (membership.value(kink + STEP) - membership.value(kink)) / STEP
        assert membership.derivative(kink) == pytest.approx(difference, abs=1e-5)


@given(memberships(), st.lists(arguments, min_size=6, max_size=6))
def test_arrays_of_any_shape_give_what_scalars_give(membership, xs):
    mu, _ = membership
    grid = np.reshape(xs, (2, 3))
    np.testing.assert_array_equal(mu.value(grid), [[mu.value(x) for x in row] for row in grid])
    np.testing.assert_array_equal(mu.derivative(grid), [[mu.derivative(x) for x in row] for row in grid])


@given(memberships())
def test_what_is_not_a_number_has_neither_membership_nor_derivative(membership):
    mu, _ = membership
    assert np.isnan(mu.value(np.nan))
    assert np.isnan(mu.derivative([np.nan, 1.0])[0])


@pytest.mark.parametrize(
    ("make", "where"),
    [
        (lambda: SaturatedRamp(5.0, 1.0), "SaturatedRamp.zero"),
        (lambda: SaturatedRamp(1.0, 1.0), "SaturatedRamp.zero"),
        (lambda: SaturatedRamp(float("nan"), 1.0), "SaturatedRamp.full"),
        (lambda: TruncatedAnnulus(inner_squared=-1.0), "TruncatedAnnulus.inner_squared"),
        (lambda: TruncatedAnnulus(4.0, 4.0), "TruncatedAnnulus.outer_squared"),
        (lambda: TruncatedAnnulus(width=0.0), "TruncatedAnnulus.width"),
        (lambda: Triangular(0.0, -1.0, 2.0), "Triangular.peak"),
        (lambda: Trapezoidal(0.0, 1.0, 2.0, 1.5), "Trapezoidal.right"),
        (lambda: Gaussian(0.0, -1.0), "Gaussian.deviation"),
        (lambda: Gaussian(float("inf"), 1.0), "Gaussian.centre"),
        (lambda: Sigmoid(0.0, 0.0), "Sigmoid.slope"),
    ],
)
def test_parameters_without_meaning_are_refused(make, where):
    with pytest.raises(BadInput) as error:
        make()
    assert error.value.where == where
