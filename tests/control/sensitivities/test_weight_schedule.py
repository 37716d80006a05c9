"""A recorded leg with other weights: what changes, and its derivatives."""

from __future__ import annotations

import numpy as np
import pytest

import mala_drake.control.sensitivities.weight_schedule as mut
from mala_drake.control import OptimalControlProblem
from mala_drake.control.action_parameters import EMPTY_HANDED, make_parameters
from mala_drake.control.reference import Reference
from mala_drake.control.sensitivities import LOWER, UPPER, SensitivityAnalysis
from mala_drake.control.sensitivities.recorded_leg import RecordedLeg
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.ward_map import Ward

LOGARITHMS = np.array([0.3, -0.2, 0.1, 0.0, 0.5, -0.5, 0.2, -0.1, 0.4])


@pytest.fixture(scope="module")
def problem():
    return OptimalControlProblem()


@pytest.fixture(scope="module")
def leg(problem):
    states = np.zeros((problem.horizon + 1, 6))
    states[:, 0] = np.linspace(0.0, 3.0, len(states))
    parameters = make_parameters(
        style=EMPTY_HANDED,
        weights=(0.5, 0.12, 0.14, 0.14, 0.10),
        reference=Reference(states),
        obstacles=(),
        congestion=Congestion(Ward("hall", 10.0, 0.2, 2.0, (), (), (), 0.02)),
    )
    shares = np.linspace(0.0, 1.0, len(states))
    return RecordedLeg(np.zeros(6), (parameters, parameters), (shares, shares))


def test_each_entry_is_scaled_by_its_factor_and_the_terminal_weights_with_it(problem, leg):
    columns = SensitivityAnalysis(problem).columns
    before, after = leg.steps[0], mut.weight_schedule(leg, LOGARITHMS, columns).at(0, np.zeros(6)).parameters
    np.testing.assert_allclose(after.stage.state_weights, before.stage.state_weights * np.exp(LOGARITHMS[:6]))
    np.testing.assert_allclose(after.terminal.weights, before.terminal.weights * np.exp(LOGARITHMS[:6]))
    np.testing.assert_allclose(after.stage.control_weights, before.stage.control_weights * np.exp(LOGARITHMS[6:]))
    np.testing.assert_array_equal(after.stage.references, before.stage.references)


def test_the_derivatives_of_the_parameters_are_differences(problem, leg):
    columns = SensitivityAnalysis(problem).columns

    def packed(logarithms):
        chosen = mut.weight_schedule(leg, logarithms, columns).at(1, np.zeros(6)).parameters
        values = np.zeros(columns.parameters.stop)
        values[: problem.layout.size] = problem.pack(np.zeros(6), chosen)
        values[columns.slices[LOWER]], values[columns.slices[UPPER]] = chosen.inputs.lower, chosen.inputs.upper
        return values

    schedule = mut.weight_schedule(leg, LOGARITHMS, columns)
    assert schedule.knobs == mut.WEIGHT_KNOBS == 9
    by_knobs = schedule.at(1, np.zeros(6)).by_knobs
    for i, unit in enumerate(1e-6 * np.eye(9)):
        expected = (packed(LOGARITHMS + unit) - packed(LOGARITHMS - unit)) / 2e-6
        np.testing.assert_allclose(by_knobs[:, i], expected, rtol=1e-6, atol=1e-4)
