import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.grounding import Gaussian, LocationMembership, SaturatedRamp, Triangular, TruncatedAnnulus

coordinates = st.floats(-6.0, 6.0)
points = st.tuples(coordinates, coordinates)
profiles = st.sampled_from([SaturatedRamp(), TruncatedAnnulus(), Gaussian(0.0, 2.0)])
STEP = 1e-6


def finite_differences(function, at):
    steps = STEP * np.eye(2)
    return np.array([(function(at + step) - function(at - step)) / (2.0 * STEP) for step in steps])


@given(points, points, profiles)
def test_gradients_are_those_of_finite_differences(centre, position, profile):
    distance = np.hypot(*np.subtract(position, centre))
    assume(distance > 0.1 and abs(distance - 1.0) > 1e-4 and abs(distance - 5.0) > 1e-4)
    location = LocationMembership(centre, profile)
    np.testing.assert_allclose(
        location.gradient(position), finite_differences(location.value, np.array(position)), atol=1e-7
    )


def test_the_gradient_at_the_centre_is_zero_even_on_a_tip():
    tip = LocationMembership((1.0, 2.0), Triangular(0.0, 0.0, 2.0))
    np.testing.assert_array_equal(tip.gradient((1.0, 2.0)), [0.0, 0.0])


def test_many_positions_at_once():
    location = LocationMembership((0.0, 0.0))
    positions = np.array([[[0.0, 0.0], [3.0, 0.0]], [[0.0, -2.0], [3.0, 4.0]]])
    np.testing.assert_allclose(location.value(positions), [[1.0, 0.5], [0.75, 0.0]])
    np.testing.assert_allclose(location.gradient(positions)[0], [[0.0, 0.0], [-0.25, 0.0]])


def test_a_centre_that_is_not_finite_is_refused():
    with pytest.raises(BadInput, match=r"location\.y"):
        LocationMembership((0.0, float("nan")))
