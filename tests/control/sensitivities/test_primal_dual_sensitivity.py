"""Against the dense linear system of the paper's eq. (IFT), and against differences of solutions."""

from __future__ import annotations

import itertools
from dataclasses import replace

import casadi
import numpy as np
import pytest

from mala_drake.control import MakeSolver
from mala_drake.control.sensitivities import LOWER, UPPER, SensitivityAnalysis

PARTS = ("states", "controls", "costates", "lower_multipliers", "upper_multipliers")


@pytest.fixture(scope="module")
def analysis(small):
    return SensitivityAnalysis(small)


def stacked(zeta):
    """All variables of a point or of its derivative in the order of the reference, the columns last."""
    return np.concatenate([(part := getattr(zeta, name)).reshape(-1, *part.shape[2:]) for name in PARTS])


@pytest.mark.parametrize("barrier", [1e-1, 1e-4])
def test_it_solves_the_dense_system_of_the_implicit_function_theorem(
    analysis, reference, solve, start, choose, barrier
):
    point = solve(start, choose(), barrier)
    by_variables, by_columns = reference.evaluate(
        [casadi.jacobian(reference.kappa, reference.variables), casadi.jacobian(reference.kappa, reference.columns)],
        point,
    )
    expected = np.linalg.solve(by_variables, -by_columns)
    actual = stacked(analysis.primal_dual(point)[0])
    scale = np.abs(expected).max(axis=0)
    np.testing.assert_allclose(actual / np.maximum(scale, 1.0), expected / np.maximum(scale, 1.0), atol=1e-8)


def test_every_column_is_the_difference_of_solutions(analysis, solve, start, choose, perturbed):
    point = solve(start, choose(), 1e-6)
    sensitivity, conditions = analysis.primal_dual(point)
    assert conditions.regular
    share = np.maximum(point.lower_multipliers, point.upper_multipliers)
    assert (share > 1).any()  # Strictly active bounds ...
    assert (share < 1e-4).any()  # ... and inactive ones.
    actual = stacked(sensitivity)
    for column in range(analysis.columns.size):
        ends = [stacked(perturbed(point, column, size)) for size in (1e-5, -1e-5)]
        expected = (ends[0] - ends[1]) / 2e-5
        np.testing.assert_allclose(
            actual[:, column], expected, atol=1e-5 * (1 + np.abs(expected).max()), err_msg=column
        )


def test_controls_and_duals_follow_those_of_snopt(small, analysis, start, choose):
    """Without a barrier on the other side: SNOPT's own multipliers at a tight tolerance."""
    solver = MakeSolver("snopt", small, tolerance=1e-10)
    chosen = choose()
    solution = solver.solve(start, chosen)
    analysis = SensitivityAnalysis(small, barrier=1e-9)
    sensitivity, conditions = analysis.primal_dual(analysis.polish(solution, start, chosen))
    assert conditions.regular
    step = 1e-4
    for name, entry in (("x", 0), ("yaw", 2), ("forward velocity", 3)):
        moved = chosen.terminal.target.copy()
        ends = []
        for size in (step, -step):
            target = moved.copy()
            target[entry] += size
            terminal = replace(chosen.terminal, target=target)
            ends.append(solver.solve(start, replace(chosen, terminal=terminal), solution.controls))
        column = analysis.columns.slices["terminal.target"].start + entry
        controls = (ends[0].controls - ends[1].controls) / (2 * step)
        duals = (ends[0].control_duals - ends[1].control_duals) / (2 * step)
        np.testing.assert_allclose(sensitivity.controls[..., column], controls, atol=1e-4, err_msg=name)
        own = (sensitivity.lower_multipliers - sensitivity.upper_multipliers)[..., column]
        np.testing.assert_allclose(own, duals, atol=1e-4 * (1 + np.abs(duals).max()), err_msg=name)
        assert np.abs(duals).max() > 0.1


def test_the_error_of_the_barrier_is_of_the_order_of_nu(analysis, solve, start, choose):
    barriers = (1e-3, 1e-4, 1e-5)
    exact, *rough = (stacked(analysis.primal_dual(solve(start, choose(), barrier))[0]) for barrier in (1e-9, *barriers))
    errors = [np.abs(each - exact).max() for each in rough]
    for larger, smaller in itertools.pairwise(errors):
        assert 8 < larger / smaller < 12


def test_an_active_bound_takes_its_control_along_and_an_inactive_one_moves_nothing(analysis, solve, start, choose):
    point = solve(start, choose(), 1e-8)
    sensitivity, _ = analysis.primal_dual(point)
    lower, upper = (analysis.columns.slices[name].start for name in (LOWER, UPPER))
    for stage, control in np.ndindex(point.controls.shape):
        for multipliers, first in ((point.lower_multipliers, lower), (point.upper_multipliers, upper)):
            active = multipliers[stage, control] > 1e-2
            derivative = sensitivity.controls[stage, control, first + control]
            if active:
                assert derivative == pytest.approx(1.0, abs=1e-4)
    inactive = [i for i in range(3) if point.upper_multipliers[:, i].max() < 1e-5]
    assert inactive
    for i in inactive:
        np.testing.assert_allclose(sensitivity.controls[..., upper + i], 0, atol=1e-4)
