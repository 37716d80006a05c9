import math

import numpy as np
import pytest

from mala_drake.grounding import SaturatedRamp, TruncatedAnnulus


def test_the_pieces_are_the_papers():
    annulus = TruncatedAnnulus(inner_squared=4.0, outer_squared=9.0, width=2.0)
    assert annulus.value(1.9) == 1.0
    assert annulus.value(2.5) == pytest.approx(math.exp(-(2.5**2 - 4.0) / 2.0**2))
    assert annulus.value(3.1) == 0.0


def test_rims_belong_to_one_piece_each():
    annulus = TruncatedAnnulus(inner_squared=4.0, outer_squared=9.0, width=2.0)
    assert annulus.value(2.0) == 1.0  # The paper's two indicators would make it 2.
    assert annulus.value(3.0) == 0.0  # "A distance at least d^1 away": crisply not there.


def test_the_default_crosses_the_threshold_where_the_ramp_does():
    assert TruncatedAnnulus().value(2.2) == pytest.approx(float(SaturatedRamp().value(2.2)))


def test_membership_never_rises_with_distance():
    values = TruncatedAnnulus().value(np.linspace(0.0, 8.0, 400))
    assert np.all(np.diff(values) <= 0.0)
