import numpy as np
import pytest

from mala_drake.grounding import SaturatedRamp


def test_the_defaults_are_the_papers_formula():
    distances = np.array([0.0, 0.5, 1.0, 2.0, 3.0, 4.5, 5.0, 9.0])
    np.testing.assert_allclose(SaturatedRamp().value(distances), [1.0, 1.0, 1.0, 0.75, 0.5, 0.125, 0.0, 0.0])


def test_the_threshold_of_the_paper_is_crossed_at_two_point_two_metres():
    assert SaturatedRamp().value(2.2) == pytest.approx(0.7)


def test_the_slope_is_a_quarter_a_metre():
    np.testing.assert_array_equal(SaturatedRamp().derivative([0.5, 2.0, 7.0]), [0.0, -0.25, 0.0])


def test_an_infinite_distance_is_outside():
    assert SaturatedRamp().value(np.inf) == 0.0
    assert SaturatedRamp().derivative(np.inf) == 0.0
