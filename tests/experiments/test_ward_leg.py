"""Recorded legs, and the sensitivities of whole legs of the ward against differences of the closed loop."""

from __future__ import annotations

import numpy as np
import pytest

import mala_drake.experiments.ward_leg as mut
from mala_drake.control import MakeSolver, OptimalControlProblem
from mala_drake.control.leg import LegRules
from mala_drake.control.sensitivities import (
    ClosedLoop,
    SensitivityAnalysis,
    SimulationModel,
    adjoint,
    forward,
)
from mala_drake.control.sensitivities.recorded_leg import KNOBS, NOMINAL
from mala_drake.ward.ward_map import LoadWard

WARD = LoadWard()


@pytest.fixture(scope="module")
def problem():
    return OptimalControlProblem()


@pytest.fixture(scope="module")
def leg(problem):
    return mut.record_leg(problem, MakeSolver("rti", problem), WARD, "home", "charge_main")


def test_the_recorded_leg_ends_at_its_place(problem, leg):
    place = WARD.place["charge_main"]
    np.testing.assert_array_equal(leg.initial_state, [0, 0, 0, 0, 0, 0])
    np.testing.assert_allclose(leg.steps[-1].terminal.target[:2], (place.x, place.y), atol=1e-9)
    assert leg.shares[0][0] == 0.0
    assert leg.shares[-1][-1] == 1.0
    assert all((np.diff(shares) >= 0).all() for shares in leg.shares)


def test_a_leg_that_does_not_succeed_is_an_error(problem, monkeypatch):
    monkeypatch.setattr(mut, "LegRules", lambda: LegRules(step_budget=3))
    with pytest.raises(RuntimeError, match="from home to charge_main ended as step_budget"):
        mut.record_leg(problem, MakeSolver("rti", problem), WARD, "home", "charge_main")


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["snopt", "rti"])
@pytest.mark.parametrize(
    ("start", "goal"), [("home", "charge_main"), ("supply_A", "patient_bed_left"), ("home", "pharmacy_south")]
)
def test_the_sensitivities_of_a_whole_leg(problem, solver, start, goal):
    """N = 20, 60 to 110 steps: forward equals adjoint to 1e-8, and both differences of the closed loop to 1e-5."""
    mpc, analysis = MakeSolver(solver, problem), SensitivityAnalysis(problem)
    leg = mut.record_leg(problem, mpc, WARD, start, goal)
    loop = ClosedLoop(analysis, mpc, SimulationModel(period=problem.period))
    model = leg.steps[0].dynamics.vector

    def run(knobs=NOMINAL, offset=0.0):
        return loop.run(leg.initial_state + offset, leg.with_knobs(knobs, analysis.columns), model, len(leg.steps))

    nominal = run()
    assert nominal.differentiable
    whole = forward(nominal)
    for end in np.eye(6):
        gradient = adjoint(nominal, end)
        for name in ("by_knobs", "by_initial_state", "by_model"):
            expected = end @ getattr(whole, name).states[-1]
            np.testing.assert_allclose(getattr(gradient, name), expected, atol=1e-8 * max(np.abs(expected).max(), 1e-3))
    size = 3e-6  # Where a bound is about to become active, the curvature is great.
    for i, unit in enumerate(np.eye(4)):
        ends = [run(NOMINAL + sign * size * unit).states for sign in (1, -1)]
        expected = (ends[0] - ends[1]) / (2 * size)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(whole.by_knobs.states[..., i], expected, atol=1e-5 * scale, err_msg=KNOBS[i])
    for i, unit in enumerate(np.eye(6)):
        ends = [run(offset=sign * 1e-5 * unit).states for sign in (1, -1)]
        expected = (ends[0] - ends[1]) / 2e-5
        scale = np.abs(expected).max()
        np.testing.assert_allclose(whole.by_initial_state.states[..., i], expected, atol=1e-5 * scale)
