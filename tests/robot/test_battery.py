"""The battery alone, and the battery of a cruising robot."""

from __future__ import annotations

import math

import pytest
from pydrake.systems.analysis import Simulator

from mala_drake.errors import BadInput
from mala_drake.robot import battery as mut
from mala_drake.robot.drive_law import DriveLaw
from mala_drake.ward.congestion import CRUISE_SPEED

X, V_X = 0, 3


@pytest.fixture
def dut():
    return mut.Battery(initial_charge=0.8)


def _run(dut, seconds, *, power=0.0, in_place_draw=0.0, charging=0.0):
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    dut.GetInputPort("power").FixValue(context, [power])
    dut.GetInputPort("charge_rates").FixValue(context, [in_place_draw, charging])
    simulator.AdvanceTo(seconds)
    return dut.GetOutputPort("charge").Eval(context)[0]


def test_drawn_ports_are_the_real_ports(dut, assert_port_box):
    assert_port_box(dut)


def test_it_loses_energy_and_what_actions_take_and_gains_what_chargers_give(dut):
    assert _run(dut, 9.995, power=0.01 * mut.CAPACITY) == pytest.approx(0.7)
    assert _run(dut, 9.995, in_place_draw=0.02) == pytest.approx(0.6)
    assert _run(dut, 9.995, power=0.01 * mut.CAPACITY, in_place_draw=0.02, charging=0.04) == pytest.approx(0.9)


def test_it_is_never_more_than_full_nor_less_than_empty(dut):
    assert _run(dut, 100.0, charging=0.1) == 1.0
    assert _run(dut, 100.0, power=mut.CAPACITY) == 0.0


@pytest.mark.parametrize("rate", ["power", "in_place_draw", "charging"])
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_broken_reading_changes_nothing(dut, rate, bad):
    assert _run(dut, 1.0, **{rate: bad}) == 0.8


@pytest.mark.parametrize("charge", [-0.1, 1.1, math.nan])
def test_refuses_an_initial_charge_that_is_none(charge):
    with pytest.raises(BadInput, match="initial_charge"):
        mut.Battery(initial_charge=charge)


@pytest.mark.parametrize("capacity", [0.0, -1.0, math.inf, math.nan])
def test_refuses_a_capacity_that_is_none(capacity):
    with pytest.raises(BadInput, match="capacity"):
        mut.Battery(capacity=capacity)


def test_the_capacity_follows_from_the_power_at_cruise():
    seconds_per_metre = 1.0 / CRUISE_SPEED
    assert DriveLaw().cruise_power(CRUISE_SPEED) * seconds_per_metre / mut.CAPACITY == pytest.approx(0.01)


@pytest.fixture
def make_powered_bench(make_bench):
    """A robot that lives on a battery."""

    def make(initial_charge, *, hidden_truth=0.0):
        batteries = []

        def wire(builder, plant, robot, drivetrain):
            battery = builder.AddNamedSystem("battery", mut.Battery(initial_charge=initial_charge))
            builder.Connect(drivetrain.GetOutputPort("power"), battery.GetInputPort("power"))
            builder.Connect(battery.GetOutputPort("charge"), drivetrain.GetInputPort("charge"))
            batteries.append(battery)

        bench = make_bench(wire=wire, hidden_truth=hidden_truth)
        (battery,) = batteries
        context = battery.GetMyMutableContextFromRoot(bench.context)
        battery.GetInputPort("charge_rates").FixValue(context, [0.0, 0.0])
        return bench, lambda: battery.GetOutputPort("charge").Eval(context)[0]

    return make


@pytest.mark.parametrize("hidden_truth", [0.0, 1.0])
def test_cruising_costs_one_hundredth_a_metre(make_powered_bench, hidden_truth):
    bench, charge = make_powered_bench(1.0, hidden_truth=hidden_truth)
    bench.drive(2.0, 0.0, 0.0, seconds=0.77)
    start, charge_at_start = bench.state()[X], charge()
    bench.drive(0.0, 0.0, 0.0, seconds=10.0)
    metres = bench.state()[X] - start
    assert metres > 13.0
    assert (charge_at_start - charge()) / metres == pytest.approx(0.01, rel=0.06)


def test_it_runs_empty_and_the_robot_stands(make_powered_bench):
    bench, charge = make_powered_bench(0.08)
    bench.drive(2.0, 0.0, 0.0, seconds=0.75)
    bench.drive(0.0, 0.0, 0.0, seconds=10.0)
    assert charge() == 0.0
    assert abs(bench.state()[V_X]) < 1e-4
    stopped_at = bench.state()[X]
    bench.drive(2.0, 0.0, 1.0, seconds=2.0)
    assert bench.state()[X] == pytest.approx(stopped_at, abs=1e-4)


def test_standing_costs_nothing(make_powered_bench):
    bench, charge = make_powered_bench(0.5)
    bench.drive(0.0, 2.0, 0.0, seconds=5.0)
    assert charge() == pytest.approx(0.5, abs=1e-6)
