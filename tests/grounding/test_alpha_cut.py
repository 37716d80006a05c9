import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.grounding import AlphaCut, Gaussian, SaturatedRamp, Triangular


@given(
    st.sampled_from([SaturatedRamp(), Gaussian(2.0, 1.5), Triangular(0.0, 1.0, 4.0)]),
    st.floats(0.01, 1.0),
    st.floats(0.0, 8.0),
)
def test_it_is_the_set_of_what_belongs_well_enough(membership, level, x):
    assert AlphaCut(membership, level).value(x) == (1.0 if membership.value(x) >= level else 0.0)
    assert AlphaCut(membership, level).derivative(x) == 0.0


def test_by_default_it_is_cut_where_atoms_begin_to_hold():
    np.testing.assert_array_equal(AlphaCut(SaturatedRamp()).value([0.0, 2.19, 2.21, 9.0]), [1.0, 1.0, 0.0, 0.0])


def test_nan_stays_nan():
    assert np.isnan(AlphaCut(SaturatedRamp()).value(np.nan))
    assert np.isnan(AlphaCut(SaturatedRamp()).derivative(np.nan))


@pytest.mark.parametrize("level", [0.0, -0.1, 1.1, np.nan])
def test_levels_that_are_no_degrees_are_refused(level):
    with pytest.raises(BadInput, match="level"):
        AlphaCut(SaturatedRamp(), level)
