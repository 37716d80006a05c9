from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import mala_drake.control.sensitivities.closed_loop as mut
from mala_drake.control import MakeSolver
from mala_drake.control.sensitivities import ConstantParameters, SensitivityAnalysis, SimulationModel


@pytest.fixture(scope="module")
def analysis(small):
    return SensitivityAnalysis(small)


def test_it_applies_the_polished_policy_to_the_model(small, analysis, solve, start, choose):
    chosen = choose(obstacles=())  # One way only: a warm start leads to no other optimum.
    loop = mut.ClosedLoop(analysis, MakeSolver("snopt", small), SimulationModel(period=small.period))
    truth = chosen.dynamics.vector * 1.02
    run = loop.run(start, ConstantParameters(chosen, analysis.columns, ("terminal",)), truth, 3)
    assert run.differentiable
    assert run.states.shape == (4, 6)
    state = start
    for i in range(3):
        control = solve(state, chosen).controls[0]
        np.testing.assert_allclose(run.controls[i], control, atol=1e-7)
        state = small.step(state, control, truth).full()[:, 0]
        np.testing.assert_allclose(run.states[i + 1], state, atol=1e-7)


def test_a_failed_solve_is_told_and_gives_no_number(small, analysis, choose):
    loop = mut.ClosedLoop(analysis, MakeSolver("snopt", small), SimulationModel(period=small.period))
    leg = ConstantParameters(choose(), analysis.columns, ("terminal",))
    run = loop.run(np.full(6, np.nan), leg, choose().dynamics.vector, 2)
    assert not run.differentiable
    assert [step.solved for step in run.steps] == [False, False]
    assert np.isnan(run.steps[0].policy_by_knobs).all()


def test_a_weakly_active_bound_is_irregular_yet_differentiable(small, analysis, start, choose):
    # Standing at the goal neither drive nor brake is wanted: the brake's lower bound is reached, and no more.
    state = np.array([0.5, 0.2, 0.1, 0.0, 0.0, 0.0])
    chosen = choose(goal=state, obstacles=())
    references = np.tile(state, (small.horizon, 1))
    chosen = replace(chosen, stage=replace(chosen.stage, references=references))
    loop = mut.ClosedLoop(analysis, MakeSolver("snopt", small), SimulationModel(period=small.period))
    run = loop.run(state, ConstantParameters(chosen, analysis.columns, ("terminal",)), chosen.dynamics.vector, 1)
    assert not run.steps[0].regularity.regular
    assert run.differentiable
    assert run.steps[0].regularity.weakly_active[:, 1].any()
