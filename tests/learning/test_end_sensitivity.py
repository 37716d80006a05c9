"""Which sensitivity an update goes through, and how far the simulated one was from doing nothing."""

from __future__ import annotations

import numpy as np
import pytest

import mala_drake.learning.end_sensitivity as mut
from mala_drake.messages import SensitivitySource


@pytest.mark.parametrize(
    ("simulated", "deviation"),
    [
        (np.diag([0.9, 1.2]), 0.2),
        (np.array([[1.0, 0.3], [-0.3, 1.0]]), 0.3),
        (np.eye(2), 0.0),
    ],
)
def test_a_sensitivity_of_a_leg_that_stops_is_believed(simulated, deviation):
    found = mut.plausible_sensitivity(simulated)
    np.testing.assert_array_equal(found.matrix, simulated)
    assert (found.source, found.deviation) == (SensitivitySource.SIMULATED, pytest.approx(deviation))


@pytest.mark.parametrize(
    ("wrong", "deviation"),
    [
        (None, None),
        (np.full((2, 2), np.nan), None),
        (np.zeros((2, 2)), 1.0),
        (np.diag([1.0, 3.0]), 2.0),
    ],
)
def test_for_one_that_it_cannot_have_the_target_itself_stands_in_and_that_is_told(wrong, deviation):
    found = mut.plausible_sensitivity(wrong)
    np.testing.assert_array_equal(found.matrix, np.eye(2))
    assert (found.source, found.deviation) == (SensitivitySource.FALLBACK, deviation)
