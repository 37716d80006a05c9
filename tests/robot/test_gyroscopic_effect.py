"""The gyroscopic effect alone, and a robot that it acts on."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mala_drake.errors import BadInput
from mala_drake.robot import gyroscopic_effect as mut
from mala_drake.robot.plant_state import OMEGA_Z, PLANT_STATE_SIZE, QW, QZ, V_X, V_Y
from mala_drake.robot.robot_parameters import NOMINAL

YAW, OMEGA = 2, 5


def _force(bench, *, speed, omega, yaw=0.0, scale=1.0):
    dut = mut.GyroscopicEffect(bench.plant, bench.robot, scale=scale)
    context = dut.CreateDefaultContext()
    state = np.zeros(PLANT_STATE_SIZE)
    state[[QW, QZ]] = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    state[[V_X, V_Y, OMEGA_Z]] = speed * math.cos(yaw), speed * math.sin(yaw), omega
    dut.GetInputPort("plant_state").FixValue(context, state)
    return dut.GetOutputPort("generalized_force").Eval(context)


def test_drawn_ports_are_the_real_ports(make_bench, assert_port_box):
    bench = make_bench()
    assert_port_box(mut.GyroscopicEffect(bench.plant, bench.robot))


@pytest.mark.parametrize("yaw", [0.0, 1.0, -2.0])
def test_it_is_a_torque_against_the_turn_and_a_force_into_the_curve(make_bench, yaw):
    bench = make_bench()
    force = _force(bench, speed=1.2, omega=0.5, yaw=yaw)
    start = bench.robot.base.floating_velocities_start_in_v()
    torque_W, force_W = force[start : start + 3], force[start + 3 : start + 6]
    coupling = 1.2 * 0.5
    assert torque_W == pytest.approx([0, 0, -mut.YAW_COUPLING * NOMINAL.effective_yaw_inertia * coupling])
    left = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
    assert force_W == pytest.approx(mut.LATERAL_COUPLING * NOMINAL.effective_mass * coupling * left)
    assert np.count_nonzero(np.abs(force) > 1e-12) == np.count_nonzero(np.abs(force[start : start + 6]) > 1e-12)


def test_it_needs_speed_and_turning(make_bench):
    bench = make_bench()
    assert not _force(bench, speed=1.5, omega=0.0).any()
    assert not _force(bench, speed=0.0, omega=1.0).any()


def test_it_scales(make_bench):
    bench = make_bench()
    assert not _force(bench, speed=1.5, omega=1.0, scale=0.0).any()
    whole = _force(bench, speed=1.5, omega=1.0)
    assert _force(bench, speed=1.5, omega=1.0, scale=0.5) == pytest.approx(0.5 * whole)


def test_refuses_a_scale_that_is_none(make_bench):
    bench = make_bench()
    with pytest.raises(BadInput, match="scale"):
        mut.GyroscopicEffect(bench.plant, bench.robot, scale=math.nan)


def test_it_bends_the_path(make_bench):
    """The yaw rate dies away as the model has it, omega' = -c v_x omega, and the robot ends looking elsewhere."""
    rates, headings = [], []
    for scale in (0.0, 1.0):

        def wire(builder, plant, robot, drivetrain, scale=scale):
            effect = builder.AddSystem(mut.GyroscopicEffect(plant, robot, scale=scale))
            builder.Connect(plant.get_state_output_port(robot.robot), effect.GetInputPort("plant_state"))
            builder.Connect(effect.get_output_port(), plant.get_applied_generalized_force_input_port())

        bench = make_bench(wire=wire)
        bench.drive(2.0, 0.0, 0.0, seconds=0.77)
        bench.drive(0.0, 0.0, 0.8, seconds=0.5)
        bench.drive(0.0, 0.0, 0.0, seconds=3.0)
        rates.append(bench.state()[OMEGA])
        headings.append(bench.state()[YAW])
    decay = math.log(rates[0] / rates[1])
    assert decay == pytest.approx(mut.YAW_COUPLING * 1.5 * 3.2, rel=0.15)
    assert headings[0] - headings[1] > 0.2
