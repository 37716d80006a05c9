"""The shortest step, against a general optimiser and by its own conditions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

import mala_drake.learning.shortest_step as mut

demand = st.tuples(st.floats(0.05, 3.0), st.floats(0.0, 2 * np.pi)).map(
    lambda polar: polar[0] * np.array([np.cos(polar[1]), np.sin(polar[1])])
)


def test_nothing_demanded_is_no_step_and_one_demand_is_the_step():
    np.testing.assert_array_equal(mut.shortest_step([]), [0.0, 0.0])
    np.testing.assert_array_equal(mut.shortest_step([np.array([0.3, -0.4])]), [0.3, -0.4])


def test_two_demands_at_right_angles_are_both_met():
    np.testing.assert_allclose(mut.shortest_step([np.array([1.0, 0.0]), np.array([0.0, 2.0])]), [1.0, 2.0])


def test_the_longer_of_two_alike_meets_both():
    np.testing.assert_allclose(mut.shortest_step([np.array([1.0, 0.0]), np.array([2.0, 0.1])]), [2.0, 0.1])


def test_demands_that_nothing_meets_give_the_longest():
    step = mut.shortest_step([np.array([1.0, 0.0]), np.array([-2.0, 0.0])])
    np.testing.assert_array_equal(step, [-2.0, 0.0])


@given(st.lists(demand, min_size=2, max_size=3))
def test_it_is_that_of_a_general_optimiser(demands):
    angles = [abs(np.arctan2(np.cross([*a, 0], [*b, 0])[2], a @ b)) for a in demands for b in demands]
    if max(angles) > 2.5:  # Far corners are for nobody to find numerically.
        return
    step = mut.shortest_step(demands)
    constraints = [{"type": "ineq", "fun": lambda s, d=d: (d @ s - d @ d) / np.linalg.norm(d)} for d in demands]
    found = minimize(lambda s: s @ s, step + 0.1, jac=lambda s: 2 * s, constraints=constraints, method="SLSQP")
    if not found.success or any(each["fun"](found.x) < -1e-6 for each in constraints):
        return
    assert all(each["fun"](step) >= -1e-6 for each in constraints)
    assert step @ step == pytest.approx(found.fun, rel=1e-4)
