"""Boxes that sleep where nothing is near, wake in time, and change nothing else."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.geometry import Box
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantValueSource, ConstantVectorSource

from mala_drake.messages import MagnetCommand
from mala_drake.robot import sleeping_boxes as mut
from mala_drake.robot.arm_kinematics import STOWED
from mala_drake.robot.item_messages import ClampedItems
from mala_drake.robot.items import AddItems
from mala_drake.robot.magnet import Magnet
from mala_drake.robot.plant import AddCareRobot, AddFloor, MakeCarePlant, SetRobotPose
from mala_drake.ward.items import ITEM_HALF_HEIGHT, Item, ItemPose

LEDGE = 0.78
HERE, BESIDE, FAR = (
    Item(f"p/{kind}", kind, "p", ItemPose(x, y, LEDGE + ITEM_HALF_HEIGHT, 0.0))
    for kind, x, y in (("med_antibiotic", 6.0, 0.0), ("med_insulin", 6.0, 0.4), ("med_analgesic", 6.0, 9.0))
)
ITEMS = (HERE, BESIDE, FAR)
ALL = ClampedItems(tuple((item.name, item.shelf_pose) for item in ITEMS))


@pytest.fixture
def bench():
    """A robot at the origin, ledges 6 m away with clamped boxes on them."""
    builder = DiagramBuilder()
    plant, scene_graph = MakeCarePlant(builder)
    robot = AddCareRobot(plant, scene_graph)
    AddFloor(plant)
    for y in (0.2, 9.0):
        X_WL = RigidTransform([6.2, y, 0.5 * LEDGE])
        plant.RegisterCollisionGeometry(plant.world_body(), X_WL, Box(0.6, 1.0, LEDGE), f"ledge{y}", CoulombFriction())
    items = AddItems(plant, scene_graph, ITEMS, robot)
    plant.Finalize()
    magnet = builder.AddSystem(Magnet(plant, robot, items))
    builder.Connect(plant.get_state_output_port(), magnet.GetInputPort("state"))
    builder.Connect(magnet.get_output_port(), plant.get_applied_generalized_force_input_port())
    for value, port in (
        (ConstantVectorSource([0.0, 0.0]), plant.get_actuation_input_port(robot.robot)),
        (ConstantVectorSource([*STOWED, 0.0, 0.0, 0.0]), plant.get_desired_state_input_port(robot.arm)),
        (ConstantValueSource(Value(MagnetCommand())), magnet.GetInputPort("magnet")),
    ):
        builder.Connect(builder.AddSystem(value).get_output_port(), port)
    builder.ExportInput(magnet.GetInputPort("clamped"), "clamped")
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = simulator.get_mutable_context()
    clamped = diagram.GetInputPort("clamped").FixValue(context, Value(ALL))
    dut = mut.SleepingBoxes(
        plant,
        scene_graph,
        robot.base,
        items.bodies,
        lambda: clamped.GetMutableData().get_value(),
        context,
    )
    plant_context = plant.GetMyMutableContextFromRoot(context)
    return SimpleNamespace(
        dut=dut,
        plant=plant,
        plant_context=plant_context,
        scene_graph=scene_graph,
        context=context,
        robot=robot,
        items=items,
        clamp=lambda *kept: clamped.GetMutableData().set_value(
            ClampedItems(tuple((item.name, item.shelf_pose) for item in kept))
        ),
        simulator=simulator,
    )


def names(*items):
    return tuple(item.name for item in items)


def put_robot(bench, x, y=0.0):
    SetRobotPose(bench.plant, bench.plant_context, bench.robot, x=x, y=y, yaw=0.0)


def height(bench, item):
    return bench.plant.EvalBodyPoseInWorld(bench.plant_context, bench.items.body(item.name)).translation()[2]


def collisions(bench):
    """All pairs of geometries that may collide."""
    query = bench.scene_graph.get_query_output_port().Eval(bench.scene_graph.GetMyContextFromRoot(bench.context))
    return set(query.inspector().GetCollisionCandidates())


def test_they_sleep_where_nothing_is_near(bench):
    everything = collisions(bench)
    bench.dut.update()
    assert bench.dut.asleep == names(*ITEMS)
    of_boxes = {g for body in bench.items.bodies for g in bench.plant.GetCollisionGeometriesForBody(body)}
    assert collisions(bench) == {pair for pair in everything if not set(pair) & of_boxes}


def test_they_wake_before_the_robot_is_in_reach(bench):
    everything = collisions(bench)
    bench.dut.update()
    put_robot(bench, 6.0 - mut.WAKING_DISTANCE - 0.01)
    bench.dut.update()
    assert bench.dut.asleep == names(*ITEMS)
    put_robot(bench, 6.0 - mut.WAKING_DISTANCE + 0.01)
    bench.dut.update()
    assert bench.dut.asleep == names(BESIDE, FAR)
    put_robot(bench, 4.5, 4.5)
    bench.dut.update()
    put_robot(bench, 5.0, 1.0)
    bench.dut.update()
    assert bench.dut.asleep == names(FAR)
    put_robot(bench, 5.0, 8.0)
    bench.dut.update()
    assert bench.dut.asleep == names(HERE, BESIDE)
    bench.clamp()
    bench.dut.update()
    assert bench.dut.asleep == ()
    assert collisions(bench) == everything


def test_a_loose_box_wakes_its_neighbour_and_rests_on_the_ledge(bench):
    bench.dut.update()
    bench.clamp(BESIDE, FAR)
    for tick in range(10):
        bench.dut.update()
        assert bench.dut.asleep == names(FAR)
        bench.simulator.AdvanceTo(0.2 * (tick + 1))
    assert height(bench, HERE) == pytest.approx(LEDGE + ITEM_HALF_HEIGHT, abs=4e-3)
    bench.clamp(*ITEMS)
    for tick in range(10, 15):
        bench.dut.update()
        bench.simulator.AdvanceTo(0.2 * (tick + 1))
    bench.dut.update()
    assert bench.dut.asleep == names(*ITEMS)


def test_a_box_that_moves_stays_awake(bench):
    body = bench.items.body(HERE.name)
    bench.plant.SetVelocities(bench.plant_context, body.model_instance(), [0.0, 0.0, 0.0, 0.0, 0.02, 0.0])
    bench.dut.update()
    assert bench.dut.asleep == names(FAR)


def test_asleep_or_awake_the_same_happens(bench):
    reference = bench.context.Clone()
    Simulator(bench.simulator.get_system(), reference).AdvanceTo(2.0)
    for tick in range(10):
        bench.dut.update()
        bench.simulator.AdvanceTo(0.2 * (tick + 1))
    expected = bench.plant.GetPositionsAndVelocities(bench.plant.GetMyContextFromRoot(reference))
    assert np.array_equal(bench.plant.GetPositionsAndVelocities(bench.plant_context), expected)
