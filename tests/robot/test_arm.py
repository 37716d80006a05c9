"""The arm's system alone, and the arm that it moves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

from mala_drake.clock import CONTROL_OFFSET, TICK
from mala_drake.messages import ArmCommand
from mala_drake.robot import arm as mut
from mala_drake.robot.arm_kinematics import STOWED, joints_for_gripper


@pytest.fixture
def dut():
    return mut.Arm()


class _Alone:
    def __init__(self, dut):
        self.dut = dut
        self.simulator = Simulator(dut)
        self.context = self.simulator.get_mutable_context()
        self.target = dut.GetInputPort("arm_target").FixValue(self.context, Value(ArmCommand()))

    def command(self, p_BG):
        self.target.GetMutableData().set_value(ArmCommand(p_BG))

    def read(self, port):
        return self.dut.GetOutputPort(port).Eval(self.context).copy()


def test_drawn_ports_are_the_real_ports(dut, assert_port_box):
    assert_port_box(dut)


def test_it_is_stowed_until_told_otherwise(dut):
    alone = _Alone(dut)
    alone.simulator.AdvanceTo(1.0)
    assert alone.read("desired_state").tolist() == [*STOWED, 0.0, 0.0, 0.0]
    assert alone.read("reachable") == [1.0]
    assert alone.read("moving") == [0.0]


def test_it_goes_to_the_target_and_back(dut):
    alone = _Alone(dut)
    alone.command((0.6, 0.1, 0.9))
    alone.simulator.AdvanceTo(0.5)
    assert alone.read("moving") == [1.0]
    alone.simulator.AdvanceTo(5.0)
    assert alone.read("desired_state")[:3] == pytest.approx(joints_for_gripper((0.6, 0.1, 0.9)))
    assert alone.read("moving") == [0.0]
    alone.command(None)
    alone.simulator.AdvanceTo(10.0)
    assert alone.read("desired_state")[:3] == pytest.approx(STOWED)


@pytest.mark.parametrize("p_BG", [(2.0, 0.0, 0.9), (math.nan, 0.0, 0.9)])
def test_a_target_out_of_reach_is_reported_and_the_goal_kept(dut, p_BG):
    alone = _Alone(dut)
    alone.command((0.6, 0.1, 0.9))
    alone.simulator.AdvanceTo(0.5)
    alone.command(p_BG)
    alone.simulator.AdvanceTo(5.0)
    assert alone.read("reachable") == [0.0]
    assert alone.read("desired_state")[:3] == pytest.approx(joints_for_gripper((0.6, 0.1, 0.9)))
    alone.command((0.6, 0.1, 0.9))
    alone.simulator.AdvanceTo(6.0)
    assert alone.read("reachable") == [1.0]


def test_commands_are_accepted_once_a_tick(dut):
    alone = _Alone(dut)
    alone.simulator.AdvanceTo(TICK)
    alone.command((0.6, 0.1, 0.9))
    alone.simulator.AdvanceTo(TICK + 0.5 * CONTROL_OFFSET)
    assert alone.read("moving") == [0.0]
    alone.simulator.AdvanceTo(TICK + 2.0 * CONTROL_OFFSET)
    assert alone.read("moving") == [1.0]


@pytest.mark.parametrize("p_BG", [(0.4, 0.0, 0.6), (0.7, 0.24, 0.9), (0.75, -0.45, 1.1), (0.9, 0.0, 0.75)])
def test_the_gripper_gets_within_five_millimetres(make_bench, p_BG):
    arms = []

    def wire(builder, plant, robot, drivetrain):
        arm = builder.AddNamedSystem("arm", mut.Arm())
        builder.Connect(arm.GetOutputPort("desired_state"), plant.get_desired_state_input_port(robot.arm))
        builder.ExportInput(arm.GetInputPort("arm_target"), "arm_target")
        arms.append(arm)

    bench = make_bench(wire=wire)
    bench.diagram.GetInputPort("arm_target").FixValue(bench.context, Value(ArmCommand(p_BG)))
    bench.drive(0.0, 2.0, 0.0, seconds=1.0)
    (arm,) = arms
    assert arm.GetOutputPort("moving").Eval(arm.GetMyContextFromRoot(bench.context)) == [1.0]
    bench.drive(0.0, 2.0, 0.0, seconds=3.0)
    X_BG = bench.plant.CalcRelativeTransform(bench.plant_context, bench.robot.base.body_frame(), bench.robot.gripper)
    assert np.linalg.norm(X_BG.translation() - p_BG) < 0.005
    X_WG = bench.robot.gripper.CalcPoseInWorld(bench.plant_context)
    assert np.linalg.norm(X_WG.translation() - p_BG) < 0.01  # The hull leans over a little.
