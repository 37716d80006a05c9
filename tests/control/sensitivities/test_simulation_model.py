from __future__ import annotations

import casadi
import numpy as np
import pytest

import mala_drake.control.sensitivities.simulation_model as mut
from mala_drake.control import DynamicsParameters
from mala_drake.errors import BadInput

STATE, CONTROL = np.array([0.3, -0.2, 0.7, 0.9, 0.05, 0.4]), np.array([0.5, 0.1, -0.3])


def features(state, control):
    """Sliding sideways in bends, and a throttle that saturates."""
    slip = casadi.vertcat(0, 0, 0, 0, state[3] * state[5], 0)
    throttle = casadi.vertcat(0, 0, 0, casadi.tanh(control[0]), 0, 0)
    return casadi.horzcat(slip, throttle)


def test_without_a_residual_it_is_the_mpc_s_own_model(small):
    dynamics = DynamicsParameters(4.0, 0.1, 0.2, 0.97, 1.02, 0.95).vector
    transition = mut.SimulationModel(period=small.period).step(STATE, CONTROL, dynamics)
    np.testing.assert_allclose(transition.state, small.step(STATE, CONTROL, dynamics).full()[:, 0], atol=1e-14)


def test_the_residual_is_added():
    dynamics, coefficients = DynamicsParameters().vector, np.array([0.02, -0.05])
    plain = mut.SimulationModel().step(STATE, CONTROL, dynamics).state
    model = mut.SimulationModel(features)
    assert model.parameter_size == 8
    moved = model.step(STATE, CONTROL, np.concatenate((dynamics, coefficients))).state
    expected = [0, 0, 0, -0.05 * np.tanh(0.5), 0.02 * 0.9 * 0.4, 0]
    np.testing.assert_allclose(moved - plain, expected, atol=1e-14)


def test_the_jacobians_are_differences():
    model = mut.SimulationModel(features)
    parameters = np.concatenate((DynamicsParameters(4.0, 0.1, 0.2).vector, [0.02, -0.05]))
    transition = model.step(STATE, CONTROL, parameters)
    for index, jacobian in enumerate((transition.by_state, transition.by_control, transition.by_parameters)):
        for column in range(jacobian.shape[1]):
            ends = []
            for size in (1e-6, -1e-6):
                arguments = [STATE.copy(), CONTROL.copy(), parameters.copy()]
                arguments[index][column] += size
                ends.append(model.step(*arguments).state)
            np.testing.assert_allclose(jacobian[:, column], (ends[0] - ends[1]) / 2e-6, atol=1e-8)


def test_features_need_a_row_for_each_state():
    with pytest.raises(BadInput, match="5 rows; expected 6, one a state"):
        mut.SimulationModel(lambda state, _control: state[:5])
