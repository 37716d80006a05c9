"""Errors a tick ahead, of a robot that moves just as a model says."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from mala_drake.clock import TICK
from mala_drake.control.model import step_function
from mala_drake.control.parameters import DynamicsParameters
from mala_drake.experiments import model_errors as mut
from mala_drake.learning.dynamics_estimator import DynamicsEstimator
from mala_drake.messages import LearnedDynamics

REAL = DynamicsParameters(yaw_coupling=0.3, propulsion_gain=0.9)
CONTROL = np.array([0.5, 0.0, 0.2])
STEP = step_function(TICK)


def told(parameters):
    coefficients = tuple(parameters.vector.tolist())
    return LearnedDynamics(coefficients, (0.01,) * len(coefficients), 1)


def drive(dut, learned, *, control=CONTROL):
    """Ticks of a robot that is as `REAL`, the controller's model being one of `learned` in each; the states."""
    states = [np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.5])]
    for model in learned:
        dut.add(states[-1], control, model)
        states.append(np.array(STEP(states[-1], control, REAL.vector)).ravel())
    return states


def test_the_true_model_makes_no_errors_and_the_nominal_one_does():
    dut = mut.ModelErrors(DynamicsEstimator())
    states = drive(dut, [told(REAL)] * 4)
    nominal = DynamicsParameters().vector
    errors = [
        (after - np.array(STEP(before, CONTROL, nominal)).ravel())[3:]
        for before, after in itertools.pairwise(states[:-1])
    ]
    found = dut.root_mean_squares()
    assert found["learned"] == pytest.approx([0.0] * 3, abs=1e-12)
    assert found["nominal"] == pytest.approx(np.sqrt(np.mean(np.square(errors), axis=0)))
    assert found["nominal"][0] == pytest.approx(0.1 * CONTROL[0] * TICK)


def test_a_tick_is_predicted_with_what_was_known_before_it():
    dut = mut.ModelErrors(DynamicsEstimator())
    drive(dut, [LearnedDynamics(), told(REAL), told(REAL)])
    found = dut.root_mean_squares()
    # Two ticks, of which the first was predicted by the nominal model.
    assert found["learned"][0] == pytest.approx(found["nominal"][0] / np.sqrt(2.0))


def test_a_parked_robot_is_not_predicted():
    dut = mut.ModelErrors(DynamicsEstimator())
    drive(dut, [told(REAL)] * 3, control=np.array([0.0, 2.0, 0.0]))
    assert dut.root_mean_squares() == {}
