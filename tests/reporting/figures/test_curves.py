"""Labels at the ends of curves: near where they belong, and never on top of each other."""

from __future__ import annotations

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from mala_drake.reporting.figures import curves as mut

positions = st.lists(st.floats(0.0, 100.0), min_size=1, max_size=7).map(sorted)


@given(wanted=positions)
def test_labels_are_apart_and_in_order(wanted):
    placed = mut.spaced(wanted, 10.0, 0.0, 100.0)
    assert len(placed) == len(wanted)
    assert all(after - before >= 10.0 - 1e-9 for before, after in itertools.pairwise(placed))
    assert placed[0] >= -1e-9
    assert placed[-1] <= 100.0 + 1e-9


@given(wanted=st.lists(st.floats(200.0, 300.0), min_size=1, max_size=5).map(sorted))
def test_labels_move_as_little_as_they_can(wanted):
    """Against a general optimiser of the same problem; far from the ends, which limit the blocks and not each label."""
    placed = np.array(mut.spaced(wanted, 10.0, 0.0, 500.0))
    apart = {"type": "ineq", "fun": lambda x: np.diff(x) - 10.0}
    best = minimize(
        lambda x: np.sum((x - wanted) ** 2), 10.0 * np.arange(len(wanted)) + 200.0, constraints=[apart], method="SLSQP"
    )
    assert np.sum((placed - wanted) ** 2) <= best.fun + 1e-3


def test_labels_that_do_not_fit_start_at_the_lower_end():
    assert mut.spaced([1.0, 2.0, 3.0], 10.0, 0.0, 15.0) == [0.0, 10.0, 20.0]


def test_series_of_different_lengths_end_in_nan():
    array = mut.aligned([[1.0, 2.0, 3.0], [4.0]])
    np.testing.assert_array_equal(array, [[1.0, 2.0, 3.0], [4.0, np.nan, np.nan]])
