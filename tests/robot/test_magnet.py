"""The magnets' system alone, and a box on its way from a shelf to a table."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.geometry import Box
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import CoulombFriction

from mala_drake.messages import ArmCommand, MagnetCommand
from mala_drake.robot import magnet as mut
from mala_drake.robot.arm import Arm
from mala_drake.robot.arm_kinematics import PAD_OFFSETS, PAD_RADIUS, gripper_for_pad
from mala_drake.robot.item_messages import ClampedItems
from mala_drake.robot.items import ITEM_MASS, AddItems, X_WI_at
from mala_drake.robot.magnet_law import GRAVITY
from mala_drake.ward.items import ITEM_HALF_HEIGHT, Item, ItemPose

LEDGE = 0.78
ANTIBIOTIC = Item("p/med_antibiotic", "med_antibiotic", "p", ItemPose(0.70, 0.0, LEDGE + ITEM_HALF_HEIGHT, 0.0))
INSULIN = Item("p/med_insulin", "med_insulin", "p", ItemPose(0.70, 0.24, LEDGE + ITEM_HALF_HEIGHT, 4.0))
VITAMIN = Item("s/supp_vitamin_d", "supp_vitamin_d", "s", ItemPose(0.70, -0.24, LEDGE + ITEM_HALF_HEIGHT, 0.4))
ITEMS = (ANTIBIOTIC, INSULIN, VITAMIN)
ALL_CLAMPED = ClampedItems(tuple((item.name, item.shelf_pose) for item in ITEMS))
PARKED = (0.0, 2.0, 0.0)


@dataclass
class MagnetBench:
    """A robot before a ledge with three clamped boxes, with arm and magnet in the test's hands."""

    bench: object
    bodies: object
    magnet: object
    target: object
    held: object
    clamped: object

    def wait(self, seconds, control=PARKED):
        self.bench.drive(*control, seconds=seconds)

    def pose(self, item):
        return self.bench.plant.EvalBodyPoseInWorld(self.bench.plant_context, self.bodies.body(item.name))

    def position(self, item):
        return self.pose(item).translation()

    def reach(self, p_BG):
        self.target.GetMutableData().set_value(ArmCommand(None if p_BG is None else tuple(p_BG)))
        self.wait(3.5)

    def hold(self, *pairs):
        self.held.GetMutableData().set_value(MagnetCommand(tuple((item.name, pad) for item, pad in pairs)))

    def clamp(self, *items):
        pairs = tuple((item.name, item.shelf_pose) for item in items)
        self.clamped.GetMutableData().set_value(ClampedItems(pairs))

    def pad_in_world(self, pad):
        X_WG = self.bench.robot.gripper.CalcPoseInWorld(self.bench.plant_context)
        return X_WG @ np.array([0.0, PAD_OFFSETS[pad], 0.0])

    def output(self):
        context = self.magnet.GetMyContextFromRoot(self.bench.context)
        return self.magnet.GetOutputPort("generalized_force").Eval(context).copy()

    def pick(self, item, pad):
        x, y, z = self.position(item)
        above = gripper_for_pad((x, y, z + ITEM_HALF_HEIGHT + PAD_RADIUS), pad)
        self.reach(above)
        self.hold((item, pad))
        self.wait(0.5)
        self.clamp(*[other for other in ITEMS if other != item])
        self.reach((above[0], above[1], above[2] + 0.08))


@pytest.fixture
def make_magnet_bench(make_bench):
    def make(*, ledge=True):
        parts = {}

        def add(plant, scene_graph, robot):
            friction = CoulombFriction(0.6, 0.6)
            if ledge:
                X_WL = RigidTransform([0.90, 0.0, 0.5 * LEDGE])
                plant.RegisterCollisionGeometry(plant.world_body(), X_WL, Box(0.5, 1.0, LEDGE), "ledge", friction)
            X_WT = RigidTransform([-3.0, 0.0, 0.35])
            plant.RegisterCollisionGeometry(plant.world_body(), X_WT, Box(0.6, 3.0, 0.7), "table", friction)
            parts["bodies"] = AddItems(plant, scene_graph, ITEMS, robot)

        def wire(builder, plant, robot, drivetrain):
            arm = builder.AddNamedSystem("arm", Arm())
            builder.Connect(arm.GetOutputPort("desired_state"), plant.get_desired_state_input_port(robot.arm))
            magnet = builder.AddNamedSystem("magnet", mut.Magnet(plant, robot, parts["bodies"]))
            builder.Connect(plant.get_state_output_port(), magnet.GetInputPort("state"))
            builder.Connect(magnet.get_output_port(), plant.get_applied_generalized_force_input_port())
            builder.ExportInput(arm.GetInputPort("arm_target"), "arm_target")
            builder.ExportInput(magnet.GetInputPort("magnet"), "magnet")
            builder.ExportInput(magnet.GetInputPort("clamped"), "clamped")
            parts["magnet"] = magnet

        bench = make_bench(add=add, wire=wire)
        fixed = [
            bench.diagram.GetInputPort(name).FixValue(bench.context, Value(value))
            for name, value in (("arm_target", ArmCommand()), ("magnet", MagnetCommand()), ("clamped", ALL_CLAMPED))
        ]
        return MagnetBench(bench, parts["bodies"], parts["magnet"], *fixed)

    return make


def test_drawn_ports_are_the_real_ports(make_magnet_bench, assert_port_box):
    assert_port_box(make_magnet_bench().magnet)


def test_clamped_boxes_stand_still_in_the_air(make_magnet_bench):
    dut = make_magnet_bench(ledge=False)
    dut.wait(5.0)
    for item in ITEMS:
        assert dut.pose(item).IsNearlyEqualTo(X_WI_at(item.shelf_pose), 1e-9)


def test_at_rest_the_force_is_the_boxes_weight_and_nothing_else(make_magnet_bench):
    dut = make_magnet_bench()
    force = dut.output()
    assert np.sort(force)[-3:] == pytest.approx([ITEM_MASS * GRAVITY] * 3)
    assert np.count_nonzero(force) == 3


def test_nothing_is_computed_for_boxes_at_rest(make_magnet_bench, monkeypatch):
    """Whatever their yaw: half a turn and more has another quaternion than the pose it is made from."""
    dut = make_magnet_bench()

    def never(*arguments):
        pytest.fail("a wrench was computed")

    monkeypatch.setattr(mut.MagnetLaw, "wrench", never)
    dut.wait(0.5)


def test_a_clamped_box_that_is_nudged_returns(make_magnet_bench):
    dut = make_magnet_bench()
    X_WI = RigidTransform(RollPitchYaw(0.1, -0.1, 0.5), [0.69, 0.01, LEDGE + ITEM_HALF_HEIGHT + 0.02])
    plant, context = dut.bench.plant, dut.bench.plant_context
    plant.SetFreeBodyPose(context, dut.bodies.body(ANTIBIOTIC.name), X_WI)
    dut.wait(1.0)
    assert dut.pose(ANTIBIOTIC).IsNearlyEqualTo(X_WI_at(ANTIBIOTIC.shelf_pose), 1e-4)
    assert dut.pose(INSULIN).IsNearlyEqualTo(X_WI_at(INSULIN.shelf_pose), 1e-9)


def test_a_box_let_go_rests_on_the_ledge(make_magnet_bench):
    dut = make_magnet_bench()
    dut.clamp()
    dut.wait(2.0)
    for item in ITEMS:
        assert dut.position(item) == pytest.approx([item.shelf_pose.x, item.shelf_pose.y, item.shelf_pose.z], abs=4e-3)


def test_a_magnet_that_is_not_near_catches_nothing(make_magnet_bench):
    dut = make_magnet_bench()
    x, y, z = dut.position(ANTIBIOTIC)
    dut.reach(gripper_for_pad((x, y, z + ITEM_HALF_HEIGHT + PAD_RADIUS + 0.05), 0))
    dut.clamp(INSULIN, VITAMIN)
    dut.hold((ANTIBIOTIC, 0))
    dut.wait(1.0)
    dut.reach(None)
    assert dut.position(ANTIBIOTIC) == pytest.approx([x, y, z], abs=4e-3)


def test_the_gripper_feels_the_weight_that_it_carries(make_magnet_bench):
    """Force and reaction: in the sum over all bodies the magnet's vertical forces cancel but for the clamped ones."""
    dut = make_magnet_bench()
    dut.pick(ANTIBIOTIC, 0)
    dut.wait(1.0)
    force = dut.output()
    base = dut.bench.robot.base.floating_velocities_start_in_v()
    assert force[base + 5] == pytest.approx(-ITEM_MASS * GRAVITY, rel=1e-3)
    body = dut.bodies.body(ANTIBIOTIC.name).floating_velocities_start_in_v()
    assert force[body + 5] == pytest.approx(ITEM_MASS * GRAVITY, rel=1e-3)
    shoulder = dut.bench.plant.GetJointByName("shoulder_pitch", dut.bench.robot.arm).velocity_start()
    lever = dut.position(ANTIBIOTIC)[0] + 0.15
    assert force[shoulder] == pytest.approx(-ITEM_MASS * GRAVITY * lever, rel=0.02)


def test_names_that_are_no_items_are_refused(make_magnet_bench):
    dut = make_magnet_bench()
    dut.hold((replace(ANTIBIOTIC, name="p/placebo"), 0))
    with pytest.raises(ValueError, match="p/placebo"):
        dut.output()
    dut.hold()
    dut.clamp(replace(ANTIBIOTIC, name="p/placebo"))
    with pytest.raises(ValueError, match="p/placebo"):
        dut.output()


def test_a_box_is_picked_carried_round_a_curve_and_put_on_a_table(make_magnet_bench):
    dut = make_magnet_bench()
    dut.pick(ANTIBIOTIC, 0)
    assert dut.position(ANTIBIOTIC)[2] > LEDGE + ITEM_HALF_HEIGHT + 0.06
    dut.reach(None)
    # Away from the ledge, round to the left, and off in a curve: 2 m/s^2 along and about 1 m/s^2 across.
    dut.wait(1.0, (-0.5, 0.0, 0.0))
    dut.wait(1.0)
    dut.wait(1.75, (0.0, 0.0, 1.0))
    dut.wait(1.75, (0.0, 0.0, -1.0))
    dut.wait(1.0)
    farthest = 0.0
    for control, seconds in (((2, 0, 0), 0.5), ((0, 0, 1), 0.8), ((0, 0, -1), 0.75), ((0, 2, 0), 0.8)):
        for _ in range(8):
            dut.wait(seconds / 8, control)
            hanging = dut.pad_in_world(0) - np.array([0.0, 0.0, PAD_RADIUS + ITEM_HALF_HEIGHT])
            farthest = max(farthest, np.linalg.norm(dut.position(ANTIBIOTIC) - hanging))
    assert farthest < 0.01
    dut.wait(1.0)
    # To the table: the robot is put before it, box and all, because driving there is not what is tested.
    plant, context = dut.bench.plant, dut.bench.plant_context
    base = dut.bench.robot.base
    X_BI = plant.EvalBodyPoseInWorld(context, base).inverse() @ dut.pose(ANTIBIOTIC)
    X_WB = RigidTransform(RollPitchYaw(0.0, 0.0, np.pi), [-2.2, 0.3, 0.0])
    plant.SetFreeBodyPose(context, base, X_WB)
    plant.SetFreeBodyPose(context, dut.bodies.body(ANTIBIOTIC.name), X_WB @ X_BI)
    dut.reach(gripper_for_pad((0.68, 0.0, 0.70 + 2 * ITEM_HALF_HEIGHT + PAD_RADIUS + 0.002), 0))
    dut.hold()
    dut.wait(1.0)
    put_down = dut.position(ANTIBIOTIC)
    assert put_down == pytest.approx([-2.88, 0.3, 0.70 + ITEM_HALF_HEIGHT], abs=0.012)
    dut.reach(None)
    dut.wait(3.0)
    assert dut.position(ANTIBIOTIC) == pytest.approx(put_down, abs=1e-3)
    assert dut.pose(ANTIBIOTIC).rotation().matrix()[2, 2] > 0.999


def test_both_pads_carry_at_once(make_magnet_bench):
    dut = make_magnet_bench()
    dut.pick(ANTIBIOTIC, 0)
    x, y, z = dut.position(VITAMIN)
    above = gripper_for_pad((x, y, z + ITEM_HALF_HEIGHT + PAD_RADIUS), 1)
    dut.reach((above[0], above[1], above[2] + 0.08))
    dut.reach(above)
    dut.hold((ANTIBIOTIC, 0), (VITAMIN, 1))
    dut.wait(0.5)
    dut.clamp(INSULIN)
    dut.reach(None)
    for item, pad in ((ANTIBIOTIC, 0), (VITAMIN, 1)):
        hanging = dut.pad_in_world(pad) - np.array([0.0, 0.0, PAD_RADIUS + ITEM_HALF_HEIGHT])
        assert dut.position(item) == pytest.approx(hanging, abs=3e-3)
