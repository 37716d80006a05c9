"""What tracking costs, against sums written out."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mala_drake.control import StageParameters, TerminalParameters
from mala_drake.control import tracking_cost as mut

STATE_WEIGHTS = np.array([2.0, 3.0, 5.0, 7.0, 11.0, 13.0])
CONTROL_WEIGHTS = np.array([0.5, 0.25, 2.0])


def test_a_step_costs_its_error_from_the_first_reference_and_its_effort():
    references = np.array([[1.0, 2.0, 0.1, 0.5, 0.0, 0.0], [9.0] * 6])
    stage = StageParameters(references, STATE_WEIGHTS, CONTROL_WEIGHTS)
    state, control = np.array([2.0, 2.0, 0.3, 0.0, 0.1, -0.2]), np.array([2.0, 1.0, -1.0])
    effort = 0.5 * 4.0 + 0.25 + 2.0
    error = 2.0 + 5.0 * 0.04 + 7.0 * 0.25 + 11.0 * 0.01 + 13.0 * 0.04
    assert mut.stage_cost(state, control, stage) == pytest.approx(effort + error)


def test_the_end_of_a_leg_costs_what_is_missing_to_rest_in_the_target():
    terminal = TerminalParameters(np.full(6, 9.0), STATE_WEIGHTS)
    cost = mut.terminal_cost(np.array([6.0, 1.0, 0.0, 0.1, 0.0, 0.0]), (6.0, 0.0, 0.2), terminal)
    assert cost == pytest.approx(3.0 + 5.0 * 0.04 + 7.0 * 0.01)


@pytest.mark.parametrize("turns", [-2, 0, 1])
def test_whole_turns_cost_nothing(turns):
    stage = StageParameters(np.zeros((1, 6)), STATE_WEIGHTS, CONTROL_WEIGHTS)
    state = np.array([0.0, 0.0, 0.1 + turns * math.tau, 0.0, 0.0, 0.0])
    assert mut.stage_cost(state, np.zeros(3), stage) == pytest.approx(5.0 * 0.01)
    terminal = TerminalParameters(np.zeros(6), STATE_WEIGHTS)
    assert mut.terminal_cost(state, (0.0, 0.0, 0.0), terminal) == pytest.approx(5.0 * 0.01)
