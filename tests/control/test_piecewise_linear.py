"""One number at a time, interpolated just as numpy does it for arrays."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.control import piecewise_linear as mut

NUMBERS = st.floats(-1e3, 1e3)
SAMPLES = st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=30, unique_by=lambda sample: sample[0])


@given(SAMPLES, st.data())
def test_it_is_numpys_interpolation_to_the_last_bit(samples, data):
    arguments, values = np.array(sorted(samples)).T
    function = mut.PiecewiseLinear(arguments, values)
    argument = data.draw(NUMBERS | st.sampled_from(arguments.tolist()) | st.floats(arguments[0], arguments[-1]))
    assert function(argument).hex() == float(np.interp(argument, arguments, values)).hex()
