"""The point solves the paper's system in its multiple-shooting form, stated anew and differentiated densely."""

from __future__ import annotations

import casadi
import numpy as np
import pytest

from mala_drake.control.sensitivities.kkt_point import _ratio


@pytest.mark.parametrize("barrier", [1e-2, 1e-7])
def test_kappa_vanishes(reference, solve, start, choose, barrier):
    point = solve(start, choose(), barrier)
    (residual,) = reference.evaluate([reference.kappa], point)
    gaps = 2 * point.controls.size
    np.testing.assert_allclose(residual[:-gaps], 0, atol=1e-8)
    np.testing.assert_allclose(residual[-gaps:], barrier, rtol=1e-5)
    assert (point.lower_multipliers > 0).all()
    assert (point.upper_multipliers > 0).all()


def test_multipliers_are_those_of_another_solver_of_the_multiple_shooting_form(reference, solve, start, choose):
    point = solve(start, choose(), 1e-9)
    s = reference.symbols
    w = casadi.veccat(s["states"], s["controls"])
    names = ("parameters", "initial_state")
    problem = {"x": w, "f": reference.cost, "g": casadi.vec(reference.equations)}
    problem["p"] = casadi.veccat(*(s[name] for name in names))
    options = {"print_time": 0, "ipopt": {"print_level": 0, "tol": 1e-11, "sb": "yes"}}
    free = np.full(point.states.size, np.inf)
    inputs = point.parameters.inputs
    result = casadi.nlpsol("other", "ipopt", problem, options)(
        x0=np.concatenate((point.states.ravel(), point.controls.ravel())),
        p=np.concatenate((point.packed, point.initial_state)),
        lbx=np.concatenate((-free, np.tile(inputs.lower, len(point.controls)))),
        ubx=np.concatenate((free, np.tile(inputs.upper, len(point.controls)))),
        lbg=0,
        ubg=0,
    )
    controls = result["x"].full()[point.states.size :].reshape(point.controls.shape)
    np.testing.assert_allclose(controls, point.controls, atol=1e-6)
    np.testing.assert_allclose(result["lam_g"].full()[:, 0], point.costates.ravel(), rtol=1e-5, atol=1e-5)
    duals = result["lam_x"].full()[point.states.size :].reshape(point.controls.shape)
    np.testing.assert_allclose(-duals, point.lower_multipliers - point.upper_multipliers, rtol=1e-5, atol=1e-5)


def test_curvatures_of_bounds_are_multiplier_over_slack_and_zero_where_there_is_no_variable(solve, start, choose):
    point = solve(start, choose(), 1e-3)
    np.testing.assert_allclose(
        point.lower_curvature, 1e-3 / (point.controls - point.parameters.inputs.lower) ** 2, rtol=1e-5
    )
    np.testing.assert_allclose(
        point.upper_curvature, 1e-3 / (point.parameters.inputs.upper - point.controls) ** 2, rtol=1e-5
    )
    np.testing.assert_array_equal(_ratio(np.array([1.0, 0.0]), np.array([4.0, 0.0])), [0.25, 0.0])
