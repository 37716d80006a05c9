"""The boxes in the plant: where they stand, what they weigh, how they look, and that they rest on things."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.geometry import Role
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from mala_drake.robot import items as mut
from mala_drake.robot.plant import AddCareRobot, AddFloor, MakeCarePlant
from mala_drake.ward.items import ITEM_HALF_HEIGHT, ITEM_SIZE, KINDS, KITCHEN_KINDS, Item, ItemPose

ITEMS = (
    Item("pharmacy_north/med_antibiotic", "med_antibiotic", "pharmacy_north", ItemPose(1.0, 2.0, 0.83, 1.5)),
    Item("supply_A/supp_omega3", "supp_omega3", "supply_A", ItemPose(-1.0, 1.0, 0.5 * ITEM_SIZE[2], -2.0)),
    Item("attic/oddity", "oddity", "attic", ItemPose(3.0, 0.0, 0.2, 0.0)),
)


@pytest.fixture
def scene():
    builder = DiagramBuilder()
    plant, scene_graph = MakeCarePlant(builder)
    robot = AddCareRobot(plant, scene_graph)
    AddFloor(plant)
    bodies = mut.AddItems(plant, scene_graph, ITEMS, robot)
    plant.Finalize()
    return builder.Build(), plant, robot, bodies


def test_each_item_is_a_free_body_of_its_name_on_its_shelf(scene):
    _, plant, _, bodies = scene
    context = plant.CreateDefaultContext()
    assert bodies.names == tuple(item.name for item in ITEMS)
    for item in ITEMS:
        body = bodies.body(item.name)
        assert body.is_floating_base_body()
        assert plant.GetModelInstanceName(body.model_instance()) == item.name
        assert plant.EvalBodyPoseInWorld(context, body).IsNearlyEqualTo(mut.X_WI_at(item.shelf_pose), 1e-12)


def test_weight_and_inertia_are_those_the_magnet_counts_on(scene):
    _, plant, _, bodies = scene
    context = plant.CreateDefaultContext()
    for body in bodies.bodies:
        inertia = body.CalcSpatialInertiaInBodyFrame(context)
        assert inertia.get_mass() == pytest.approx(mut.ITEM_MASS)
        assert inertia.get_com() == pytest.approx(np.zeros(3))
        moments = inertia.CalcRotationalInertia().get_moments()
        a, b, c = (size**2 for size in ITEM_SIZE)
        assert moments == pytest.approx(mut.ITEM_MASS / 12.0 * np.array([b + c, a + c, a + b]), rel=1e-4)
        assert moments.mean() == pytest.approx(mut.ITEM_INERTIA, rel=0.02)


def test_kinds_are_told_apart_by_colour(scene):
    diagram, plant, _, bodies = scene
    kinds = {kind for group in (*KINDS.values(), *KITCHEN_KINDS.values()) for kind in group}
    assert kinds == set(mut.KIND_COLORS)
    assert len(set(mut.KIND_COLORS.values())) == len(kinds)
    root = diagram.CreateDefaultContext()
    query = plant.get_geometry_query_input_port().Eval(plant.GetMyContextFromRoot(root))
    inspector = query.inspector()
    for item, body in zip(ITEMS[:2], bodies.bodies, strict=False):
        colors = [
            inspector.GetProperties(g, Role.kIllustration).GetProperty("phong", "diffuse").rgba
            for g in plant.GetVisualGeometriesForBody(body)
            if "coloured_" in inspector.GetName(g)
        ]
        expected = [float(value) for value in mut.KIND_COLORS[item.kind].split()]
        assert colors
        assert all(color == pytest.approx(expected) for color in colors)


def test_a_box_left_to_itself_rests_upright_on_the_floor(scene):
    diagram, plant, robot, bodies = scene
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.get_actuation_input_port(robot.robot).FixValue(context, [0.0, 0.0])
    plant.get_desired_state_input_port(robot.arm).FixValue(context, [0.0, 1.69, -2.5, 0.0, 0.0, 0.0])
    simulator.AdvanceTo(4.0)
    standing, dropped = (plant.EvalBodyPoseInWorld(context, bodies.bodies[i]) for i in (1, 2))
    assert standing.translation() == pytest.approx([-1.0, 1.0, ITEM_HALF_HEIGHT], abs=3e-3)
    assert standing.rotation().matrix()[2, 2] > 0.9999
    assert dropped.translation()[2] == pytest.approx(ITEM_HALF_HEIGHT, abs=3e-3)
    for body in bodies.bodies[1:]:
        assert np.abs(plant.EvalBodySpatialVelocityInWorld(context, body).get_coeffs()).max() < 1e-3


def test_a_box_on_its_shelf_costs_no_contact(scene):
    diagram, plant, _, _ = scene
    root = diagram.CreateDefaultContext()
    query = plant.get_geometry_query_input_port().Eval(plant.GetMyContextFromRoot(root))
    inspector = query.inspector()
    touching = [
        inspector.GetName(g)
        for pair in query.ComputePointPairPenetration()
        for g in (pair.id_A, pair.id_B)
        if "omega3" in inspector.GetName(g)
    ]
    assert touching == []  # The second item's shelf is the floor itself.
