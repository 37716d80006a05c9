import casadi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.control.penalty as mut

WIDTH = 0.05
excess = casadi.SX.sym("e")
VALUE = casadi.Function("v", [excess], [mut.huberised_hinge(excess, WIDTH)])
SLOPE = casadi.Function("s", [excess], [casadi.gradient(mut.huberised_hinge(excess, WIDTH), excess)])


@pytest.mark.parametrize(("e", "value"), [(-1.0, 0.0), (0.0, 0.0), (0.025, 0.00625), (0.05, 0.025), (1.0, 0.975)])
def test_the_hinge_is_flat_then_quadratic_then_of_slope_one(e, value):
    assert float(VALUE(e)) == pytest.approx(value, abs=1e-12)


@given(st.floats(-0.2, 0.2))
def test_the_slope_is_the_derivative_by_finite_differences(e):
    numeric = (float(VALUE(e + 1e-7)) - float(VALUE(e - 1e-7))) / 2e-7
    assert float(SLOPE(e)) == pytest.approx(numeric, abs=1e-5)
    assert float(mut.hinge_slope(e, WIDTH)) == pytest.approx(numeric, abs=1e-5)


@given(st.floats(0.1, 50.0))
def test_the_penalty_is_exact_once_its_slope_exceeds_the_multiplier(pull):
    # minimise -pull * x subject to x <= 0: the multiplier is `pull`. On a grid, the penalised minimum is feasible.
    x = np.linspace(-0.2, 0.2, 201)
    penalised = -pull * x + 1.01 * pull * VALUE(WIDTH + x[None, :]).full()[0]
    assert -WIDTH <= x[int(np.argmin(penalised))] <= 1e-9


def test_a_penalty_weaker_than_the_multiplier_gives_way():
    x = np.linspace(-0.2, 0.2, 201)
    penalised = -2.0 * x + 1.0 * VALUE(WIDTH + x[None, :]).full()[0]
    assert x[int(np.argmin(penalised))] == pytest.approx(0.2)
