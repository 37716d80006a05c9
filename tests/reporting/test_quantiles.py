"""Quantiles: numpy's where all numbers are finite, and sensible where some are not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.reporting import quantiles as mut

finite = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=12)


@given(values=finite, fraction=st.floats(0.0, 1.0))
def test_finite_numbers_have_numpys_quantile(values, fraction):
    assert mut.quantile(values, fraction) == pytest.approx(np.quantile(values, fraction), rel=1e-9, abs=1e-9)


def test_a_run_that_never_converged_is_later_than_any_other():
    assert mut.spread([1.0, 2.0, math.inf]) == mut.Spread(2.0, 1.5, math.inf)
    assert mut.spread([3.0, math.inf, math.inf]) == mut.Spread(math.inf, math.inf, math.inf)
    assert mut.quantile([2.0, math.inf], 0.0) == 2.0


def test_what_is_not_a_number_is_left_out():
    assert mut.spread([math.nan, 4.0]) == mut.Spread(4.0, 4.0, 4.0)
    assert math.isnan(mut.quantile([math.nan], 0.5))
    assert math.isnan(mut.quantile([], 0.5))
