"""The state estimator alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydrake.math import RotationMatrix
from pydrake.systems.analysis import Simulator

from mala_drake.clock import TICK
from mala_drake.errors import BadInput
from mala_drake.robot import state_estimator as mut
from mala_drake.robot.plant_state import OMEGA_Z, PLANT_STATE_SIZE, QW, QZ, V_X, V_Y, X, Y


def _plant_state(*, x=0.0, y=0.0, yaw=0.0, v_W=(0.0, 0.0), omega=0.0):
    state = np.zeros(PLANT_STATE_SIZE)
    state[[QW, QZ]] = math.cos(yaw / 2), math.sin(yaw / 2)
    state[[X, Y, V_X, V_Y, OMEGA_Z]] = x, y, *v_W, omega
    return state


def _start(dut, plant_state, *, episode=0):
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    value = dut.GetInputPort("plant_state").FixValue(context, plant_state)
    dut.SetEpisode(context, episode)
    simulator.Initialize()
    return simulator, value


def _read(dut, simulator):
    return dut.GetOutputPort("robot_state").Eval(simulator.get_context()).copy()


def test_drawn_ports_are_the_real_ports(assert_port_box):
    assert_port_box(mut.StateEstimator())


@pytest.mark.parametrize("yaw", [0.0, 1.0, -2.5, 3.14])
def test_reports_the_planar_state_with_velocities_in_the_body_frame(yaw):
    v_B = np.array([1.2, -0.1, 0.0])
    v_W = RotationMatrix.MakeZRotation(yaw) @ v_B
    dut = mut.StateEstimator()
    simulator, _ = _start(dut, _plant_state(x=3.0, y=-4.0, yaw=yaw, v_W=v_W[:2], omega=0.7))
    assert _read(dut, simulator) == pytest.approx([3.0, -4.0, yaw, 1.2, -0.1, 0.7])


def test_samples_once_a_tick():
    dut = mut.StateEstimator()
    simulator, plant_state = _start(dut, _plant_state(x=1.0))
    simulator.AdvanceTo(0.5 * TICK)
    plant_state.GetMutableData().get_mutable_value().SetFromVector(_plant_state(x=2.0))
    simulator.AdvanceTo(0.9 * TICK)
    assert _read(dut, simulator)[0] == 1.0
    simulator.AdvanceTo(1.1 * TICK)
    assert _read(dut, simulator)[0] == 2.0


def test_a_delay_is_counted_in_ticks():
    dut = mut.StateEstimator(delay=2)
    simulator, plant_state = _start(dut, _plant_state(x=1.0))
    seen = []
    for tick in range(6):
        simulator.AdvanceTo((tick + 0.5) * TICK)
        seen.append(_read(dut, simulator)[0])
        plant_state.GetMutableData().get_mutable_value().SetFromVector(_plant_state(x=tick + 2.0))
    assert seen == [1.0, 1.0, 1.0, 2.0, 3.0, 4.0]


def test_noise_has_the_deviation_asked_for_and_wraps_the_yaw():
    noise = (0.02, 0.01, 0.05, 0.03, 0.0, 0.1)
    dut = mut.StateEstimator(noise=noise, seed=3)
    truth = np.array([1.0, 2.0, math.pi - 0.001, 0.0, 0.0, 0.0])
    simulator, _ = _start(dut, _plant_state(x=1.0, y=2.0, yaw=math.pi - 0.001))
    samples = []
    for tick in range(400):
        simulator.AdvanceTo((tick + 0.5) * TICK)
        samples.append(_read(dut, simulator))
    assert np.abs(np.array(samples)[:, 2]).max() <= math.pi
    errors = np.array(samples) - truth
    errors[:, 2] = np.remainder(errors[:, 2] + math.pi, 2 * math.pi) - math.pi
    assert errors.std(axis=0) == pytest.approx(noise, rel=0.15)
    assert np.abs(errors.mean(axis=0)) == pytest.approx(np.zeros(6), abs=0.015)


def test_noise_depends_on_seed_episode_and_tick_alone():
    def run(seed, episode, *, ticks=3):
        dut = mut.StateEstimator(noise=(0.1,) * 6, seed=seed)
        simulator, _ = _start(dut, _plant_state(), episode=episode)
        simulator.AdvanceTo((ticks - 0.5) * TICK)
        return _read(dut, simulator).tolist()

    assert run(1, 5) == run(1, 5)
    assert run(1, 5) != run(1, 6)
    assert run(1, 5) != run(2, 5)
    assert run(1, 5) != run(1, 5, ticks=4)


@pytest.mark.parametrize("options", [{"noise": (0.1,) * 5}, {"noise": (math.nan,) * 6}, {"noise": (-1.0,) * 6}])
def test_refuses_noise_that_is_none(options):
    with pytest.raises(BadInput, match="noise"):
        mut.StateEstimator(**options)


def test_refuses_a_negative_delay():
    with pytest.raises(BadInput, match="delay"):
        mut.StateEstimator(delay=-1)
