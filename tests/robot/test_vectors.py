"""Vectors of plain floats, against numpy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.robot import vectors as mut

numbers = st.floats(-10.0, 10.0)
vectors = st.tuples(numbers, numbers, numbers)


@given(a=vectors, b=vectors, s=numbers, t=numbers)
def test_operations_are_those_of_linear_algebra(a, b, s, t):
    first, second = np.array(a), np.array(b)
    assert mut.plus(a, b) == pytest.approx(first + second)
    assert mut.minus(a, b) == pytest.approx(first - second)
    assert mut.combined(s, a, t, b) == pytest.approx(s * first + t * second)
    assert mut.cross(a, b) == pytest.approx(np.cross(first, second))
    assert mut.dot(a, b) == pytest.approx(first @ second)
