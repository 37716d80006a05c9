import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import expit

from mala_drake.grounding import Sigmoid


@given(st.floats(-5, 5), st.floats(0.1, 5), st.floats(-20, 20))
def test_it_is_the_logistic_function(centre, slope, x):
    np.testing.assert_allclose(Sigmoid(centre, slope).value(x), expit(slope * (x - centre)), atol=1e-12)


def test_far_arguments_saturate_without_overflow():
    np.testing.assert_array_equal(Sigmoid(0.0, 50.0).value([-1e6, 1e6]), [0.0, 1.0])
    np.testing.assert_array_equal(Sigmoid(0.0, 50.0).derivative([-1e6, 1e6]), [0.0, 0.0])


def test_a_negative_slope_falls():
    assert Sigmoid(0.2, -40.0).value(0.1) > 0.9
    assert Sigmoid(0.2, -40.0).value(0.3) < 0.1
