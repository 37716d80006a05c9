"""The drivetrain alone, and the robot that it drives over a flat floor."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mala_drake.robot import drivetrain as mut
from mala_drake.robot.plant_state import LEFT_WHEEL_SPEED, PLANT_STATE_SIZE, RIGHT_WHEEL_SPEED

X, Y, YAW, V_X, V_Y, OMEGA = range(6)
PARKED = (0.0, 2.0, 0.0)


@pytest.fixture
def dut():
    return mut.Drivetrain()


def _torques(dut, *, control, wheel_speeds=(0.0, 0.0), charge=1.0):
    context = dut.CreateDefaultContext()
    state = np.zeros(PLANT_STATE_SIZE)
    state[[LEFT_WHEEL_SPEED, RIGHT_WHEEL_SPEED]] = wheel_speeds
    dut.GetInputPort("control").FixValue(context, control)
    dut.GetInputPort("plant_state").FixValue(context, state)
    dut.GetInputPort("charge").FixValue(context, [charge])
    return dut.GetOutputPort("wheel_torques").Eval(context), dut.GetOutputPort("power").Eval(context)[0]


def test_drawn_ports_are_the_real_ports(dut, assert_port_box):
    assert_port_box(dut)


def test_ports_carry_what_the_drive_law_says(dut):
    torques, power = _torques(dut, control=[1.0, 0.0, 0.5], wheel_speeds=(9.0, 10.0))
    expected = mut.DriveLaw().torques(1.0, 0.0, 0.5, 9.0, 10.0)
    assert tuple(torques) == expected
    assert power == mut.DriveLaw().power(expected, 9.0, 10.0) > 0.0


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("entry", [0, 1, 2])
def test_a_control_that_is_not_finite_brakes(dut, bad, entry):
    control = [1.0, 0.0, 0.5]
    control[entry] = bad
    torques, _ = _torques(dut, control=control, wheel_speeds=(10.0, 10.0))
    assert np.array_equal(torques, _torques(dut, control=PARKED, wheel_speeds=(10.0, 10.0))[0])
    assert (torques < 0.0).all()


def test_an_empty_battery_brakes(dut):
    torques, power = _torques(dut, control=[2.0, 0.0, 1.0], wheel_speeds=(10.0, 10.0), charge=0.0)
    assert (torques < 0.0).all()
    assert power == 0.0


def test_accelerates_at_two_metres_per_second_squared_without_skidding(make_bench):
    bench = make_bench()
    slips = []
    for _ in range(15):
        bench.drive(2.0, 0.0, 0.0, seconds=0.05)
        state = bench.plant_state()
        slips.append(0.1 * state[LEFT_WHEEL_SPEED] - bench.state()[V_X])
    assert bench.state()[V_X] == pytest.approx(1.5, rel=0.03)
    assert max(slips) < 0.01


def test_brakes_to_rest_and_never_reverses(make_bench):
    bench = make_bench()
    bench.drive(2.0, 0.0, 0.0, seconds=0.75)
    speeds, positions = [], []
    # A little propulsion beside the brake, as a controller leaves it, must not make a difference.
    for propulsion in (0.0, 1e-6) * 30:
        bench.drive(propulsion, 2.0, 0.0, seconds=0.04)
        speeds.append(bench.state()[V_X])
        positions.append(bench.state()[X])
    assert speeds[10] == pytest.approx(1.48 - 2.0 * 11 * 0.04, abs=0.05)
    assert max(positions) - positions[-1] < 1e-3  # The hull rocks back on its casters, the wheels do not.
    assert abs(speeds[-1]) < 1e-4


def test_a_parked_robot_holds_still(make_bench):
    bench = make_bench()
    bench.drive(*PARKED, seconds=1.0)
    before = np.array(bench.state())
    bench.drive(*PARKED, seconds=20.0)
    assert np.abs(np.array(bench.state()) - before).max() < 1e-5


def test_turns_at_the_commanded_yaw_acceleration(make_bench):
    bench = make_bench()
    bench.drive(0.0, 0.0, 1.0, seconds=1.0)
    assert bench.state()[OMEGA] == pytest.approx(1.0, rel=0.05)
    assert math.hypot(*bench.state()[:2]) < 5e-3


def test_drives_straight_when_the_nominal_model_is_the_truth(make_bench):
    bench = make_bench()
    bench.drive(2.0, 0.0, 0.0, seconds=0.75)
    bench.drive(0.0, 0.0, 0.0, seconds=4.0)
    assert bench.state()[X] > 6.0
    assert abs(bench.state()[Y]) < 0.01
    assert bench.state()[V_X] == pytest.approx(1.5, rel=0.03)  # The rolling resistance is compensated.


def test_drifts_when_the_truth_is_another(make_bench):
    drifts = []
    for scale in (0.5, 1.0):
        bench = make_bench(hidden_truth=scale)
        bench.drive(2.0, 0.0, 0.0, seconds=0.75)
        bench.drive(0.0, 0.0, 0.0, seconds=4.0)
        drifts.append(abs(bench.state()[Y]))
    assert 0.1 < drifts[0] < 0.7 * drifts[1]
    assert drifts[1] < 1.0


def test_an_empty_battery_stops_a_moving_robot(make_bench):
    bench = make_bench()
    bench.drive(2.0, 0.0, 0.0, seconds=0.75)
    bench.charge.GetMutableData().get_mutable_value().SetFromVector([0.0])
    bench.drive(2.0, 0.0, 1.0, seconds=1.5)
    assert abs(bench.state()[V_X]) < 1e-3
    stopped_at = bench.state()[X]
    bench.drive(2.0, 0.0, 1.0, seconds=2.0)
    assert bench.state()[X] == pytest.approx(stopped_at, abs=1e-4)
