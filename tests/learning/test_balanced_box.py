"""The projection onto a box with sum zero: by its variational inequality, and what it leaves alone."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mala_drake.errors import BadInput
from mala_drake.learning.balanced_box import project_to_balanced_box

points = arrays(float, st.integers(1, 9), elements=st.floats(-50.0, 50.0))
bounds = st.tuples(st.floats(-3.0, -0.01), st.floats(0.01, 3.0))


@given(points, bounds, st.randoms(use_true_random=False))
def test_it_is_the_nearest_point_there(point, box, random):
    lowest, highest = box
    nearest = project_to_balanced_box(point, lowest, highest)
    assert nearest.min() >= lowest
    assert nearest.max() <= highest
    assert nearest.sum() == pytest.approx(0.0, abs=1e-9)
    # (x - point)'(y - x) >= 0 for every y of the convex set: small differences of two entries, where there is room.
    for _ in range(10):
        i, j = random.randrange(point.size), random.randrange(point.size)
        room = min(highest - nearest[i], nearest[j] - lowest)
        if i != j:
            assert room * ((nearest - point)[i] - (nearest - point)[j]) >= -1e-7


@given(points, bounds)
def test_what_is_there_stays(point, box):
    inside = project_to_balanced_box(point, *box)
    np.testing.assert_allclose(project_to_balanced_box(inside, *box), inside, atol=1e-9)


def test_by_hand():
    assert project_to_balanced_box([1.0, 2.0, 6.0], -2.0, 2.0) == pytest.approx([-1.5, -0.5, 2.0])


@pytest.mark.parametrize(
    ("point", "lowest", "highest"), [([1.0], 0.5, 1.0), ([1.0], -1.0, -0.5), ([np.nan], -1.0, 1.0)]
)
def test_what_cannot_be_projected_is_refused(point, lowest, highest):
    with pytest.raises(BadInput):
        project_to_balanced_box(point, lowest, highest)
