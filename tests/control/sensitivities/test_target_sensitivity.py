"""How a leg ends when its target is moved, against differences of the whole closed loop over the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import mala_drake.control.sensitivities.target_sensitivity as mut
from mala_drake.control.action_parameters import learned_style
from mala_drake.control.leg import LegRules
from mala_drake.control.parameters import DynamicsParameters
from mala_drake.control.sensitivities import ClosedLoop, ClosedLoopRun, SensitivityAnalysis, SimulationModel
from mala_drake.control.sensitivities.leg_simulator import LegSimulator
from mala_drake.control.sensitivities.recorded_leg import NOMINAL, LegRecorder
from mala_drake.control.solver_by_horizon import solver_of_kind
from mala_drake.messages import DrivenLeg, LearnedDynamics, LearnedWeights

from .hall import GO, HALL, THERE, make

WEIGHTS = (0.2,) * 5
NOMINAL_ROBOT = LearnedDynamics()


def sensitivity(problem, rules=None, learned=NOMINAL_ROBOT, kind="receding", **how):
    own = mut.TargetSensitivity(make(LegSimulator, problem, rules, kind=kind))
    return own(DrivenLeg(GO, (0.0,) * 6, THERE, obstacles=HALL.shapes, preferences=WEIGHTS, dynamics=learned, **how))


# A robot that skids, answers less and turns wide.
LEARNED = LearnedDynamics((3.0, 0.2, 0.3, 0.8, 0.9, 0.7), (0.01,) * 6, 100)


LOOSE = LearnedWeights((("there", (0.25, 1.0, 4.0, 2.0)),))  # In position, and in no hurry.


@pytest.mark.parametrize(
    ("learned", "weights", "kind"),
    [
        (NOMINAL_ROBOT, LearnedWeights(), "receding"),
        (LEARNED, LearnedWeights(), "receding"),
        (NOMINAL_ROBOT, LOOSE, "receding"),
        (LEARNED, LOOSE, "shrinking"),
    ],
    ids=["nominal", "learned dynamics", "learned weights", "shrinking horizon"],
)
def test_it_is_that_of_differences_of_the_closed_loop(problem, learned, weights, kind):
    style = learned_style(GO, weights, carrying=False)
    dynamics = DynamicsParameters(*learned.coefficients) if learned.updates else None
    recorder = make(LegRecorder, problem, kind=kind)
    leg = recorder.record(np.zeros(6), THERE, HALL.shapes, style=style, weights=WEIGHTS, dynamics=dynamics)
    np.testing.assert_array_equal(leg.steps[0].dynamics.vector, (dynamics or DynamicsParameters()).vector)
    analysis = SensitivityAnalysis(problem)
    loop = ClosedLoop(analysis, solver_of_kind(kind, "rti", problem)[0], SimulationModel(period=problem.period))
    model, size = leg.steps[0].dynamics.vector, 1e-4

    def end(knob, step):
        schedule = leg.with_knobs(NOMINAL + step * np.eye(4)[knob], analysis.columns)
        return loop.run(leg.initial_state, schedule, model, len(leg.steps)).states[-1, :2]

    expected = np.stack([(end(knob, size) - end(knob, -size)) / (2 * size) for knob in range(2)], axis=1)
    found = sensitivity(problem, learned=learned, weights=weights, kind=kind)
    np.testing.assert_allclose(found, expected, atol=1e-4)


def breaking(monkeypatch, at):
    """Makes the step `at` of every closed loop one without a derivative."""
    whole = ClosedLoop.run

    def broken(self, *arguments):
        steps = list(whole(self, *arguments).steps)
        steps[at] = replace(steps[at], solved=False)
        return ClosedLoopRun(tuple(steps))

    monkeypatch.setattr(ClosedLoop, "run", broken)


def test_a_step_without_a_derivative_long_before_the_end_is_forgotten(problem, monkeypatch):
    whole = sensitivity(problem)
    breaking(monkeypatch, 2)
    np.testing.assert_allclose(sensitivity(problem), whole, atol=0.05)


@pytest.mark.parametrize(("at", "why"), [(-1, "no derivative at its end"), (-4, "no derivative near its end")])
def test_an_end_without_a_derivative_is_an_error(problem, monkeypatch, at, why):
    breaking(monkeypatch, at)
    with pytest.raises(RuntimeError, match=why):
        sensitivity(problem)


def test_a_leg_that_fails_in_simulation_is_an_error(problem):
    with pytest.raises(RuntimeError, match="ended as step_budget"):
        sensitivity(problem, LegRules(step_budget=3))
