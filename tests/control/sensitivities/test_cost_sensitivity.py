"""How the cost of a leg moves with its weights: against differences of the whole closed loop, and put to use."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import mala_drake.control.sensitivities.cost_sensitivity as mut
from mala_drake.control import MakeSolver
from mala_drake.control.action_parameters import EMPTY_HANDED, learned_style
from mala_drake.control.leg import LegRules
from mala_drake.control.sensitivities import ClosedLoop, ClosedLoopRun, SensitivityAnalysis, SimulationModel
from mala_drake.control.sensitivities.leg_cost import LegCost
from mala_drake.control.sensitivities.leg_simulator import LegSimulator
from mala_drake.control.sensitivities.recorded_leg import LegRecorder
from mala_drake.control.sensitivities.weight_schedule import weight_schedule
from mala_drake.control.solver_by_horizon import solver_of_kind
from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION
from mala_drake.learning.weight_estimator import WeightEstimator
from mala_drake.messages import DrivenLeg, LearnedDynamics, LearnedWeights, Shape
from mala_drake.robot.drive_charge import charge_rate

from .hall import GO, HALL, THERE, make

WEIGHTS = (0.5, 0.12, 0.14, 0.14, 0.10)
PRICES = (0.004, 0.5, 0.14, 0.014, 0.08)
COST = LegCost(bed=Shape("bed", 2.0, 2.2, 0.3, 0.8, 0.4), charge_rate=charge_rate)


def gradient(problem, rules=None, *, prices=PRICES, bedsides=("there",), kind="receding", **how):
    own = mut.CostSensitivity(make(LegSimulator, problem, rules, kind=kind), cost=COST, bedsides=bedsides)
    leg = DrivenLeg(GO, (0.0,) * 6, THERE, obstacles=HALL.shapes, preferences=WEIGHTS, **how)
    return own(leg, prices=prices)


@pytest.fixture(scope="module")
def nominal(problem):
    return gradient(problem)


def assert_differences(found, problem, leg, *, kind="receding"):
    """Compares a gradient with central differences of the closed loop's cost, by one entry of each kind."""
    analysis = SensitivityAnalysis(problem)
    loop = ClosedLoop(analysis, solver_of_kind(kind, "rti", problem)[0], SimulationModel(period=problem.period))

    def cost(logarithms):
        schedule = weight_schedule(leg, logarithms, analysis.columns)
        run = loop.run(leg.initial_state, schedule, leg.steps[0].dynamics.vector, len(leg.steps))
        return COST(run.states, run.controls, THERE, PRICES).value

    directions = np.eye(9)[[0, 2, 3, 6]]
    expected = np.array([cost(1e-3 * each) - cost(-1e-3 * each) for each in directions]) / 2e-3
    assert np.abs(expected).max() > 1e-5
    np.testing.assert_allclose(directions @ found, expected, atol=0.01 * np.abs(expected).max())


def test_it_is_that_of_differences_of_the_closed_loop(problem, nominal):
    leg = make(LegRecorder, problem).record(np.zeros(6), THERE, HALL.shapes, style=EMPTY_HANDED, weights=WEIGHTS)
    assert_differences(nominal, problem, leg)


def test_a_horizon_that_shrinks_is_differentiated_as_it_is(problem, nominal):
    recorder = make(LegRecorder, problem, kind="shrinking")
    leg = recorder.record(np.zeros(6), THERE, HALL.shapes, style=EMPTY_HANDED, weights=WEIGHTS)
    found = gradient(problem, kind="shrinking")
    assert_differences(found, problem, leg, kind="shrinking")
    assert np.abs(found - nominal).max() > 0.01 * np.abs(nominal).max()


def test_a_common_factor_of_all_weights_changes_next_to_nothing(nominal):
    assert abs(nominal.sum()) < 0.1 * np.abs(nominal).max()


def test_the_leg_is_driven_as_it_was_with_what_was_learned_then(problem, nominal):
    factors = LearnedWeights(factors=(("there", (2.0, 1.0, 0.5, 1.0)),))
    gains = LearnedWeights(gains=tuple(map(tuple, (1.2 * DEFAULT_TRANSLATION.gains).tolist())))
    heavy = LearnedDynamics((5.0, 0.0, 0.0, 0.9, 0.9, 0.9), (0.1,) * 6, updates=9)
    legs = [gradient(problem, weights=factors), gradient(problem, weights=gains), gradient(problem, dynamics=heavy)]
    for each in legs:
        assert np.abs(each - nominal).max() > 1e-3 * np.abs(nominal).max()
    style = learned_style(GO, factors, carrying=False)
    leg = make(LegRecorder, problem).record(np.zeros(6), THERE, HALL.shapes, style=style, weights=WEIGHTS)
    assert_differences(legs[0], problem, leg)


def test_the_approach_error_counts_at_bedsides_alone(problem):
    only = (0.0, 0.0, 0.0, 0.0, 1.0)
    assert gradient(problem, prices=only).any()
    assert not gradient(problem, prices=only, bedsides=()).any()


def test_the_mismatch_to_a_wrong_prediction_falls_by_the_learned_weights(problem):
    """In the closed loop over the model as it is driven, with references that follow the robot, not as recorded."""
    recorder, analysis = make(LegRecorder, problem), SensitivityAnalysis(problem)
    learner = WeightEstimator(["there"])
    state = learner.initial_state()
    loop = ClosedLoop(analysis, MakeSolver("rti", problem), SimulationModel(period=problem.period))

    def cost(learned):
        style = learned_style(GO, learned, carrying=False)
        leg = recorder.record(np.zeros(6), THERE, HALL.shapes, style=style, weights=WEIGHTS)
        schedule = weight_schedule(leg, np.zeros(9), analysis.columns)
        run = loop.run(leg.initial_state, schedule, leg.steps[0].dynamics.vector, len(leg.steps))
        return COST(run.states, run.controls, THERE, PRICES).value

    predicted = 0.997 * cost(LearnedWeights())
    mismatches = []
    for _ in range(4):
        learned = LearnedWeights(learner.learned(state))
        mismatches.append(cost(learned) - predicted)
        state = learner.update(state, "there", mismatches[-1], gradient(problem, weights=learned))
    assert abs(mismatches[-1]) < 0.5 * abs(mismatches[0])
    assert np.abs(np.log(learner.factors(state, "there"))).max() > 0.05


def breaking(monkeypatch, at):
    """Makes the step `at` of every closed loop one without a derivative."""
    whole = ClosedLoop.run

    def broken(self, *arguments):
        steps = list(whole(self, *arguments).steps)
        steps[at] = replace(steps[at], solved=False)
        return ClosedLoopRun(tuple(steps))

    monkeypatch.setattr(ClosedLoop, "run", broken)


def test_what_comes_after_a_break_counts_if_it_is_most_of_the_leg(problem, nominal, monkeypatch):
    breaking(monkeypatch, 2)
    after = gradient(problem)
    assert after @ nominal > 0.5 * np.linalg.norm(after) * np.linalg.norm(nominal)


def test_a_leg_that_breaks_near_its_end_has_no_gradient(problem, monkeypatch):
    breaking(monkeypatch, -3)
    with pytest.raises(RuntimeError, match="has no derivative in the"):
        gradient(problem)


def test_a_leg_that_fails_in_simulation_has_no_gradient(problem):
    with pytest.raises(RuntimeError, match="ended as step_budget"):
        gradient(problem, LegRules(step_budget=3))
