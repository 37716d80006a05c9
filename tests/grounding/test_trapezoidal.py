import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.grounding import Trapezoidal


@given(st.lists(st.floats(-50, 50), min_size=4, max_size=4, unique=True), st.floats(-60, 60))
def test_values_are_those_of_linear_interpolation(corners, x):
    corners = sorted(corners)
    np.testing.assert_allclose(
        Trapezoidal(*corners).value(x), np.interp(x, corners, [0.0, 1.0, 1.0, 0.0]), rtol=1e-9, atol=1e-9
    )


def test_vertical_edges_make_a_crisp_interval_with_its_ends():
    interval = Trapezoidal(1.0, 1.0, 2.0, 2.0)
    np.testing.assert_array_equal(interval.value([0.999, 1.0, 1.5, 2.0, 2.001]), [0.0, 1.0, 1.0, 1.0, 0.0])
    np.testing.assert_array_equal(interval.derivative([0.5, 1.0, 1.5, 2.0, 2.5]), np.zeros(5))


def test_one_vertical_edge_leaves_the_other_sloped():
    np.testing.assert_allclose(Trapezoidal(0.0, 0.0, 1.0, 3.0).value([-0.1, 0.0, 2.0]), [0.0, 1.0, 0.5])


def test_the_steepest_edge_there_is_neither_overflows_nor_loses_its_ends():
    steep = Trapezoidal(0.0, 5e-324, 1.0, 1.0 + 2.3e-16)
    np.testing.assert_array_equal(steep.value([-1e300, 0.0, 5e-324, 1.0, 2.0]), [0.0, 0.0, 1.0, 1.0, 0.0])
