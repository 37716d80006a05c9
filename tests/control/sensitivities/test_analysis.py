from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

import mala_drake.control.sensitivities.analysis as mut
from mala_drake.control import SOLVER_NAMES, InputParameters, MakeSolver
from mala_drake.control.sensitivities import LOWER, UPPER
from mala_drake.control.sensitivities.interior_point import InteriorPoint
from mala_drake.errors import BadInput


@pytest.fixture(scope="module")
def analysis(small):
    return mut.SensitivityAnalysis(small)


@pytest.fixture(scope="module")
def reference_point(analysis, solve, start, choose):
    return solve(start, choose())


@pytest.mark.parametrize("name", SOLVER_NAMES)
def test_the_solver_does_not_matter(small, analysis, start, choose, reference_point, name):
    solution = MakeSolver(name, small).solve(start, choose())
    assert solution.success
    point = analysis.polish(solution, start, choose())
    policy, expected = analysis.policy(point), analysis.policy(reference_point)
    assert policy.regularity.differentiable
    np.testing.assert_allclose(policy.jacobian, expected.jacobian, atol=1e-6 * np.abs(expected.jacobian).max())
    whole, _ = analysis.primal_dual(point)
    expected, _ = analysis.primal_dual(reference_point)
    for item in fields(whole):
        ours, theirs = getattr(whole, item.name), getattr(expected, item.name)
        assert np.isfinite(ours).all()
        np.testing.assert_allclose(ours, theirs, atol=1e-6 * np.abs(theirs).max(), err_msg=item.name)


def test_a_derivative_that_does_not_exist_is_not_a_number(small, analysis, start, choose):
    point = InteriorPoint(small, iteration_limit=0).polish(np.zeros((small.horizon, 3)), start, choose())
    assert np.isnan(analysis.policy(point).jacobian).all()
    whole, conditions = analysis.primal_dual(point)
    assert not conditions.converged
    assert all(np.isnan(getattr(whole, item.name)).all() for item in fields(whole))


def test_a_bound_that_is_also_the_other_bound_has_no_derivative(analysis, solve, start, choose):
    inputs = InputParameters(np.array([-1.0, 0.2, -0.8]), np.array([1.0, 0.2, 0.8]))
    jacobian = analysis.policy(solve(start, choose(inputs=inputs))).jacobian
    for name in (LOWER, UPPER):
        place = analysis.columns.slices[name]
        assert np.isnan(jacobian[:, place][:, 1]).all()
        assert np.isfinite(jacobian[:, place][:, [0, 2]]).all()
    assert np.isfinite(jacobian[:, : analysis.columns.slices[LOWER].start]).all()
    np.testing.assert_allclose(jacobian[1], np.where(np.isnan(jacobian[1]), np.nan, 0.0))


def test_an_invalid_solution_gives_no_number_and_no_warning(small, analysis, choose):
    state = np.full(6, np.nan)
    solution = MakeSolver("snopt", small).solve(state, choose())
    policy = analysis.policy(analysis.polish(solution, state, choose()))
    assert not policy.regularity.differentiable
    assert np.isnan(policy.jacobian).all()


def test_an_unknown_group_is_refused(analysis, solve, start, choose):
    with pytest.raises(BadInput, match="'patience'"):
        analysis.policy(solve(start, choose()), ("patience",))
