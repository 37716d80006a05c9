"""DAQP on soft-row problems: the KKT conditions, which prove a minimum of a convex problem, and another method."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

import mala_drake.control.qp.daqp as mut
from mala_drake.control.qp import QpStatus


def assert_is_the_minimum(problem, solution, accuracy):
    assert solution.status is QpStatus.SOLVED
    x, soft = solution.point, np.isfinite(problem.prices)
    scale = np.abs(problem.gradient).max() + np.abs(problem.hessian).max()
    force = problem.rows.T @ solution.row_duals
    slope = problem.hessian @ x + problem.gradient + solution.box_duals + force
    assert np.abs(slope).max() < accuracy * (scale + np.abs(force).max())
    assert (x >= problem.lower).all()
    assert (x <= problem.upper).all()
    excess = problem.rows @ x - problem.bounds
    assert excess[~soft].max(initial=0.0) < accuracy
    assert solution.row_duals.min(initial=0.0) > -accuracy
    prices = problem.prices[soft]
    expected = prices * np.maximum(excess[soft], 0.0)
    np.testing.assert_allclose(solution.row_duals[soft], expected, atol=accuracy * (1 + prices.max(initial=0.0)))
    slack_hard = solution.row_duals[~soft] * excess[~soft]
    assert np.abs(slack_hard).max(initial=0.0) < accuracy * (1 + np.abs(solution.row_duals).max(initial=0.0))
    inside = (x > problem.lower + 1e-6) & (x < problem.upper - 1e-6)
    assert np.abs(solution.box_duals[inside]).max(initial=0.0) < accuracy * scale
    assert (solution.box_duals[x < problem.lower + 1e-9] < accuracy * scale).all()
    assert (solution.box_duals[x > problem.upper - 1e-9] > -accuracy * scale).all()


@given(seed=st.integers(0, 10_000), soft=st.integers(0, 12), hard=st.integers(0, 3))
def test_the_kkt_conditions_hold(make_qp, seed, soft, hard):
    problem = make_qp(seed, soft=soft, hard=hard)
    assert_is_the_minimum(problem, mut.DaqpSolver().solve(problem), 1e-5)


@pytest.mark.parametrize("seed", range(5))
def test_another_method_finds_no_better_point(make_qp, seed):
    problem = make_qp(seed, hard=0)

    def cost_and_slope(x):
        excess = np.maximum(problem.rows @ x - problem.bounds, 0.0)
        return problem.objective(x), problem.hessian @ x + problem.gradient + problem.rows.T @ (problem.prices * excess)

    box = list(zip(problem.lower, problem.upper, strict=True))
    other = minimize(cost_and_slope, np.zeros(12), jac=True, bounds=box, method="L-BFGS-B", options={"maxiter": 10_000})
    found = problem.objective(mut.DaqpSolver().solve(problem).point)
    assert found <= other.fun + 1e-9 * abs(other.fun)
    assert found == pytest.approx(other.fun, rel=1e-3)


@pytest.mark.parametrize("seed", range(5))
def test_the_active_set_as_a_guess_saves_iterations_and_changes_nothing(make_qp, seed):
    problem, solver = make_qp(seed), mut.DaqpSolver()
    cold = solver.solve(problem)
    warm = solver.solve(problem, np.concatenate((cold.box_duals, cold.row_duals)))
    wrong = solver.solve(problem, -np.concatenate((cold.box_duals, cold.row_duals)))
    assert warm.iterations < cold.iterations
    np.testing.assert_allclose(warm.point, cold.point, atol=1e-9)
    np.testing.assert_allclose(wrong.point, cold.point, atol=1e-9)


def test_hard_rows_that_contradict_the_box_are_told(make_qp):
    problem = make_qp(0, soft=2, hard=1)
    beyond = dataclasses.replace(problem, bounds=problem.bounds - 100.0)
    solution = mut.DaqpSolver().solve(beyond)
    assert solution.status is QpStatus.INFEASIBLE
    assert (solution.point >= problem.lower).all()
    assert (solution.point <= problem.upper).all()
    assert solution.row_duals.shape == (3,)


@pytest.mark.parametrize("part", ["hessian", "gradient", "rows", "bounds", "upper"])
def test_numbers_that_are_not_finite_are_answered_not_raised(make_qp, part):
    problem, solver = make_qp(1), mut.DaqpSolver()
    broken = getattr(problem, part).copy()
    broken.flat[0] = np.nan
    values = {part: broken} if part != "hessian" else {"hessian": broken, "transform": broken}
    assert solver.solve(dataclasses.replace(problem, **values)).status is QpStatus.FAILED
    assert solver.solve(problem).status is QpStatus.SOLVED
