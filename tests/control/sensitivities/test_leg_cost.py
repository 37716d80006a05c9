"""What a leg costs, against the ward's own rates, and its derivatives against differences."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mala_drake.control.sensitivities.leg_cost as mut
from mala_drake.clock import TICK
from mala_drake.robot.drive_charge import charge_rate
from mala_drake.ward.features import IDEAL_HAND_OVER, FeatureRates, approach_error, bed_shape
from mala_drake.ward.ward_map import LoadWard

WARD = LoadWard()
BED = bed_shape(WARD)
LEFT = WARD.place["patient_bed_left"]
TARGET = (LEFT.x, LEFT.y, LEFT.yaw)
COST = mut.LegCost(bed=BED, charge_rate=charge_rate)
SECOND, CHARGE, DISCOMFORT, ERROR = np.eye(5)[[0, 2, 3, 4]]


def approach(seconds=6.0):
    """States and controls of a robot that comes to the left bedside from the room and stops there."""
    times = np.arange(0.0, seconds + TICK / 2, TICK)
    left = np.maximum(seconds - 1.0 - times, 0.0)  # Metres: at 1 m/s, standing in the last second.
    states = np.zeros((len(times), 6))
    states[:, 0], states[:, 1] = TARGET[0] - left * math.cos(TARGET[2]), TARGET[1] - left * math.sin(TARGET[2])
    states[:, 2], states[:, 3] = TARGET[2] + 0.02, left > 0.0
    controls = np.random.default_rng(0).normal(size=(len(times) - 1, 3)) * 0.1
    return states, controls


def test_time_is_the_seconds_away_from_the_target():
    states, controls = approach()
    assert COST(states, controls, TARGET, SECOND).value == pytest.approx(5.0, abs=TICK)
    late = np.vstack((np.tile(states[0], (5, 1)), states))  # A second of waiting before.
    waiting = COST(late, np.vstack((np.zeros((5, 3)), controls)), TARGET, SECOND).value
    assert waiting == pytest.approx(1.0 + COST(states, controls, TARGET, SECOND).value)


def test_a_turn_of_the_robot_is_none_of_the_target():
    states, controls = approach()
    turned = states + np.array([0.0, 0.0, 2 * math.pi, 0.0, 0.0, 0.0])
    assert COST(turned, controls, TARGET, SECOND).value == pytest.approx(COST(states, controls, TARGET, SECOND).value)


def test_discomfort_is_the_rate_that_the_feature_meter_integrates():
    states, controls = approach()
    rates = FeatureRates(WARD).discomfort_rate(states[:-1, :2], states[:-1, 3])
    assert rates.max() > 0.1
    assert COST(states, controls, TARGET, DISCOMFORT).value == pytest.approx(TICK * rates.sum(), rel=1e-3)


def test_charge_is_what_the_given_rate_says():
    states, controls = approach()
    constant = mut.LegCost(bed=None, charge_rate=lambda motion, command: 0.01 + 0.0 * motion[0] * command[0])
    assert constant(states, controls, TARGET, CHARGE).value == pytest.approx(0.01 * TICK * len(controls))
    assert constant(states, controls, TARGET, DISCOMFORT).value == 0.0


def test_the_approach_error_is_that_of_the_last_pose():
    states, controls = approach()
    x, y, yaw = states[-1, :3].tolist()
    expected = approach_error((x, y, yaw), IDEAL_HAND_OVER)
    assert COST(states, controls, TARGET, ERROR).value == pytest.approx(expected, abs=1e-3)


def test_risk_has_no_price():
    states, controls = approach()
    assert COST(states, controls, TARGET, np.eye(5)[1]).value == 0.0


def test_the_derivatives_are_differences():
    states, controls = approach()
    states = states + np.random.default_rng(1).normal(size=states.shape) * 0.02
    prices = np.array([0.01, 1.0, 0.3, 0.05, 0.2])
    cost = COST(states, controls, TARGET, prices)
    for name, array, size in (("state", states, 1e-6), ("control", controls, 1e-6)):
        for index in np.ndindex(array.shape):
            ends = []
            for sign in (size, -size):
                moved = array.copy()
                moved[index] += sign
                z, u = (moved, controls) if name == "state" else (states, moved)
                ends.append(COST(z, u, TARGET, prices).value)
            gradient = cost.by_controls if name == "control" else np.vstack((cost.by_states, cost.by_end))
            assert gradient[index] == pytest.approx((ends[0] - ends[1]) / (2 * size), abs=1e-7), (name, index)
