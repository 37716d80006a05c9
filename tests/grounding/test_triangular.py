import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.grounding import Triangular


@given(st.lists(st.floats(-50, 50), min_size=3, max_size=3, unique=True), st.floats(-60, 60))
def test_values_are_those_of_linear_interpolation(corners, x):
    corners = sorted(corners)
    np.testing.assert_allclose(
        Triangular(*corners).value(x), np.interp(x, corners, [0.0, 1.0, 0.0]), rtol=1e-9, atol=1e-9
    )


def test_slopes_are_those_of_the_edges():
    np.testing.assert_allclose(Triangular(0.0, 1.0, 5.0).derivative([-1.0, 0.5, 2.0, 6.0]), [0.0, 1.0, -0.25, 0.0])
