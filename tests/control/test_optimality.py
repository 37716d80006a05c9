import numpy as np
import pytest

import mala_drake.control.optimality as mut
from mala_drake.control import InputParameters, Status


def residual(controls, gradient, curvature=4.0):
    return mut.residual(np.array(controls), np.array(gradient), np.full(3, curvature), InputParameters())


def test_the_residual_is_the_gradient_over_the_root_of_the_curvature():
    assert residual([[0.5, 1.0, 0.0]], [0.2, 0.0, 0.0]) == pytest.approx(0.1)


def test_a_gradient_against_an_active_bound_does_not_count():
    assert residual([[2.0, 0.0, 0.0]], [-5.0, 7.0, 0.0]) == 0.0
    assert residual([[2.0, 0.0, 0.0]], [0.2, 0.0, 0.0]) == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("size", "stopped", "status"),
    [
        (9e-4, Status.NUMERICAL, Status.SOLVED),
        (9e-4, Status.ITERATION_LIMIT, Status.SOLVED),
        (9e-3, Status.NUMERICAL, Status.INACCURATE),
        (9e-3, Status.ITERATION_LIMIT, Status.ITERATION_LIMIT),
        (9e-1, Status.NUMERICAL, Status.NUMERICAL),
        (np.nan, Status.NUMERICAL, Status.NUMERICAL),
    ],
)
def test_a_status_follows_from_the_residual_and_the_reason_to_stop(size, stopped, status):
    assert mut.status_of(size, 1e-4, stopped) is status


def test_the_largest_weight_sets_the_scale(parameters_toward):
    parameters = parameters_toward((1.0,))
    assert mut.cost_scale(parameters) == 1.0 / parameters.terminal.weights.max()
