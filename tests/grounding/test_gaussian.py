import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from mala_drake.grounding import Gaussian


@given(st.floats(-5, 5), st.floats(0.1, 5), st.floats(-20, 20))
def test_it_is_the_normal_density_scaled_to_one_at_its_centre(centre, deviation, x):
    density = stats.norm(centre, deviation)
    np.testing.assert_allclose(Gaussian(centre, deviation).value(x), density.pdf(x) / density.pdf(centre), rtol=1e-7)
