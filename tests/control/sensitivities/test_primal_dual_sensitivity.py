"""Against the dense linear system of the paper's eq. (IFT), and against differences of solutions."""

from __future__ import annotations

import itertools
from dataclasses import replace

import casadi
import numpy as np
import pytest

from mala_drake.control import MakeSolver
from mala_drake.control.sensitivities import LOWER, UPPER, SensitivityAnalysis
from mala_drake.experiments.ward_leg import record_leg
from mala_drake.ward.ward_map import LoadWard

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


@pytest.mark.slow
def test_every_column_of_the_full_problem_along_a_leg_of_the_ward(full):
    """N = 20 with eight obstacles: all 242 columns of all variables, at a few points of a leg.

    At this nu bounds change from active to inactive over a range of controls that is wide for the differences. Costates
    are of the order of 1e3, and the difference of two of them has lost as many digits.
    """
    problem, solve = full
    leg = record_leg(problem, MakeSolver("rti", problem), LoadWard(), "supply_A", "patient_bed_left")
    analysis = SensitivityAnalysis(problem)
    state = leg.initial_state
    for step, parameters in enumerate(leg.steps[:46]):
        point = solve(state, parameters, 1e-5)
        if step % 15 == 0:
            sensitivity, conditions = analysis.primal_dual(point)
            assert conditions.differentiable
            policy = analysis.policy(point).jacobian
            for column in range(analysis.columns.size):
                ends = [solve.perturbed(point, column, size) for size in (1e-6, -1e-6)]
                for part in PARTS:
                    expected = (getattr(ends[0], part) - getattr(ends[1], part)) / 2e-6
                    tolerance = (1e-3 if part == "costates" else 1e-5) * (1 + np.abs(expected).max())
                    actual = getattr(sensitivity, part)[..., column]
                    np.testing.assert_allclose(actual, expected, atol=tolerance, err_msg=f"{step} {part} {column}")
                    if part == "controls":
                        np.testing.assert_allclose(policy[:, column], expected[0], atol=tolerance)
        state = problem.step(state, point.controls[0], parameters.dynamics.vector).full()[:, 0]
