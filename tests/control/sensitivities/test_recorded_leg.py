"""A leg recorded in a hall, against differences of its parameters."""

from __future__ import annotations

import numpy as np
import pytest

import mala_drake.control.sensitivities.recorded_leg as mut
from mala_drake.control import MakeSolver, OptimalControlProblem
from mala_drake.control.action_parameters import EMPTY_HANDED
from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.control.sensitivities import LOWER, UPPER, SensitivityAnalysis
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.legs import LegPlanner
from mala_drake.ward.ward_map import Ward

HALL = Ward("hall", 10.0, 0.2, 2.0, (), (), (), 0.02)
THERE = (2.0, 0.6, 0.5)


@pytest.fixture(scope="module")
def problem():
    return OptimalControlProblem()


def record(problem, rules=None):
    congestion = Congestion(HALL)
    guide = LegGuide(LegPlanner(HALL), congestion, HALL.shapes, rules or LegRules())
    recorder = mut.LegRecorder(problem, MakeSolver("rti", problem), guide, congestion)
    return recorder.record(np.zeros(6), THERE, HALL.shapes, style=EMPTY_HANDED, weights=(0.2,) * 5)


@pytest.fixture(scope="module")
def leg(problem):
    return record(problem)


def test_it_begins_where_it_is_told_and_ends_at_its_target(leg):
    np.testing.assert_array_equal(leg.initial_state, np.zeros(6))
    np.testing.assert_allclose(leg.steps[-1].terminal.target[:2], THERE[:2], atol=1e-9)
    assert (leg.shares[0][0], leg.shares[-1][-1]) == (0.0, 1.0)


def test_a_leg_that_does_not_succeed_is_an_error(problem):
    with pytest.raises(RuntimeError, match=r"^ended as step_budget: 3 control steps"):
        record(problem, LegRules(step_budget=3))


def test_the_derivatives_of_the_parameters_are_differences(problem, leg):
    columns = SensitivityAnalysis(problem).columns

    def columns_at(step, knobs):
        chosen = leg.with_knobs(knobs, columns).at(step, leg.initial_state).parameters
        values = np.zeros(columns.parameters.stop)
        values[: problem.layout.size] = problem.pack(leg.initial_state, chosen)
        values[columns.slices[LOWER]], values[columns.slices[UPPER]] = chosen.inputs.lower, chosen.inputs.upper
        return values

    base = np.array([0.1, -0.2, 1.1, 0.9])
    for step in (0, 10, len(leg.steps) + 5):  # The last parameters stay.
        schedule = leg.with_knobs(base, columns)
        by_knobs = schedule.at(step, leg.initial_state).by_knobs
        for i in range(schedule.knobs):
            ends = [columns_at(step, base + size * np.eye(4)[i]) for size in (1e-6, -1e-6)]
            np.testing.assert_allclose(by_knobs[:, i], (ends[0] - ends[1]) / 2e-6, atol=1e-5)
