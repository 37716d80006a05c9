"""Forward mode, adjoint mode and differences of the closed loop, which share nothing but the simulation."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi
import numpy as np
import pytest

import mala_drake.control.sensitivities.leg_sensitivity as mut
from mala_drake.control import MakeSolver
from mala_drake.control.sensitivities import (
    GROUPS,
    ClosedLoop,
    Columns,
    ConstantParameters,
    SensitivityAnalysis,
    SimulationModel,
    StepParameters,
)

STEPS = 6
END = np.array([1.0, -2.0, 0.5, 0.3, 1.0, -0.4])


def features(state, control):
    return casadi.vertcat(0, 0, 0, control[0] * state[3], state[3] * state[5], 0.1 * casadi.sin(state[5]))


@pytest.fixture(scope="module")
def loop(small):
    solver = MakeSolver("snopt", small, tolerance=1e-6)
    return ClosedLoop(SensitivityAnalysis(small, barrier=1e-5), solver, SimulationModel(features, period=small.period))


@pytest.fixture(scope="module")
def truth(choose):
    return np.concatenate((choose().dynamics.vector * 1.03, [0.05]))


@dataclass(frozen=True)
class Following:
    """References from where the robot is to the goal, which is moved by the knobs: they answer to the state."""

    base: object
    columns: Columns
    offset: np.ndarray
    groups: tuple[str, ...] = ("terminal.target", "stage.references")
    knobs: int = 6

    def at(self, step, state):
        horizon = len(self.base.stage.references)
        goal = self.base.terminal.target + self.offset
        shares = np.arange(horizon) / horizon
        references = state + shares[:, None] * (goal - state)
        chosen = replace(
            self.base,
            terminal=replace(self.base.terminal, target=goal),
            stage=replace(self.base.stage, references=references),
        )
        by_knobs = np.zeros((self.columns.parameters.stop, 6))
        by_state = np.zeros_like(by_knobs)
        by_knobs[self.columns.of(["terminal.target"])] = np.eye(6)
        by_knobs[self.columns.of(["stage.references"])] = np.kron(shares[:, None], np.eye(6))
        by_state[self.columns.of(["stage.references"])] = np.kron(1 - shares[:, None], np.eye(6))
        return StepParameters(chosen, by_knobs, by_state)


def differences(run, count, size=1e-5):
    """Central differences of (states, controls) with respect to `count` numbers, the last axis."""
    columns = []
    for i in range(count):
        ends = [run(sign * size * np.eye(count)[i]) for sign in (1, -1)]
        columns.append(
            [(getattr(ends[0], name) - getattr(ends[1], name)) / (2 * size) for name in ("states", "controls")]
        )
    return [np.stack(parts, axis=-1) for parts in zip(*columns, strict=True)]


def check(derivative, expected):
    for actual, wanted in zip((derivative.states, derivative.controls), expected, strict=True):
        np.testing.assert_allclose(actual, wanted, atol=1e-5 * (1 + np.abs(wanted).max()))


def test_forward_is_the_difference_of_the_closed_loop_in_targets_and_states_and_the_model(loop, truth, start, choose):
    columns, chosen = loop._analysis.columns, choose()

    def leg(offset):
        terminal = replace(chosen.terminal, target=chosen.terminal.target + offset)
        return ConstantParameters(replace(chosen, terminal=terminal), columns, ("terminal.target",))

    run = loop.run(start, leg(np.zeros(6)), truth, STEPS)
    assert run.differentiable
    sensitivity = mut.forward(run)
    check(sensitivity.by_knobs, differences(lambda d: loop.run(start, leg(d), truth, STEPS), 6))
    check(sensitivity.by_initial_state, differences(lambda d: loop.run(start + d, leg(np.zeros(6)), truth, STEPS), 6))
    check(sensitivity.by_model, differences(lambda d: loop.run(start, leg(np.zeros(6)), truth + d, STEPS), 7))
    # The loop is closed: with the control held, the paper's formula as printed, it would be far off.
    moved = np.zeros((6, 6))
    for step in run.steps:
        moved = step.transition.by_state @ moved + step.transition.by_control @ step.policy_by_knobs
    assert np.abs(moved - sensitivity.by_knobs.states[-1]).max() > 0.1


def test_parameters_that_follow_the_state_close_a_second_loop(loop, truth, start, choose):
    columns, chosen = loop._analysis.columns, choose(obstacles=())

    def leg(offset):
        return Following(chosen, columns, offset)

    run = loop.run(start, leg(np.zeros(6)), truth, STEPS)
    assert run.differentiable
    sensitivity = mut.forward(run)
    check(sensitivity.by_knobs, differences(lambda d: loop.run(start, leg(d), truth, STEPS), 6))
    check(sensitivity.by_initial_state, differences(lambda d: loop.run(start + d, leg(np.zeros(6)), truth, STEPS), 6))


def test_adjoint_equals_forward_for_every_group(loop, truth, start, choose):
    run = loop.run(start, ConstantParameters(choose(), loop._analysis.columns, GROUPS[:-1]), truth, STEPS)
    whole, gradient = mut.forward(run), mut.adjoint(run, END)
    for name in ("by_knobs", "by_initial_state", "by_model"):
        expected = END @ getattr(whole, name).states[-1]
        actual = getattr(gradient, name)
        np.testing.assert_allclose(actual, expected, rtol=1e-8, atol=1e-8 * np.abs(expected).max(), err_msg=name)
        assert np.abs(expected).max() > 0


def test_adjoint_of_a_cost_along_the_way(loop, truth, start, choose):
    """The reward mismatch's sum over the leg: dG/d(z, v) d(z, v)/dp."""
    chosen = choose()
    run = loop.run(start, ConstantParameters(chosen, loop._analysis.columns, ("stage",)), truth, STEPS)
    by_states, by_controls = 2 * (run.states[:-1] - 0.3), 4 * run.controls
    gradient = mut.adjoint(run, END, by_states, by_controls)
    whole = mut.forward(run)
    for name in ("by_knobs", "by_initial_state", "by_model"):
        derivative = getattr(whole, name)
        expected = END @ derivative.states[-1]
        expected = expected + np.einsum("ti,tij->j", by_states, derivative.states[:-1])
        expected = expected + np.einsum("ti,tij->j", by_controls, derivative.controls)
        np.testing.assert_allclose(getattr(gradient, name), expected, rtol=1e-8, atol=1e-8 * np.abs(expected).max())
