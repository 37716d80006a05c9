"""The robot's model against its nominal parameters, and standing and crashing in the plant."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.geometry import Box, Cylinder, Ellipsoid, Role, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction
from pydrake.multibody.tree import JacobianWrtVariable

from mala_drake.robot import plant as mut
from mala_drake.robot.arm_kinematics import SHOULDER
from mala_drake.robot.plant_state import LEFT_WHEEL_SPEED
from mala_drake.robot.robot_parameters import NOMINAL

X, Y, YAW, V_X = range(4)


def _robot_bodies(bench):
    plant, robot = bench.plant, bench.robot
    return [*plant.GetBodyIndices(robot.robot), *plant.GetBodyIndices(robot.arm)]


def test_nominal_parameters_are_those_of_the_model(make_bench):
    bench = make_bench()
    plant, robot, context = bench.plant, bench.robot, bench.plant_context
    inertia = plant.CalcSpatialInertia(context, robot.base.body_frame(), _robot_bodies(bench))
    assert inertia.get_mass() == pytest.approx(NOMINAL.mass)
    assert inertia.CalcRotationalInertia().get_moments()[2] == pytest.approx(NOMINAL.yaw_inertia, rel=0.01)
    for name, side in (("left", 1.0), ("right", -1.0)):
        wheel = plant.GetBodyByName(f"{name}_wheel", robot.robot)
        joint = plant.GetJointByName(f"{name}_wheel_spin", robot.robot)
        actuator = plant.GetJointActuatorByName(f"{name}_wheel_spin", robot.robot)
        assert plant.EvalBodyPoseInWorld(context, wheel).translation()[1] == pytest.approx(side * NOMINAL.half_track)
        assert wheel.CalcSpatialInertiaInBodyFrame(context).CalcRotationalInertia().get_moments()[1] == pytest.approx(
            NOMINAL.wheel_inertia
        )
        assert joint.default_damping() == NOMINAL.wheel_damping
        assert actuator.effort_limit() == NOMINAL.torque_limit


def test_the_weight_rests_balanced_on_the_wheels(make_bench):
    bench = make_bench()
    inertia = bench.plant.CalcSpatialInertia(bench.plant_context, bench.robot.base.body_frame(), _robot_bodies(bench))
    center = inertia.get_com()
    assert abs(center[0]) < 0.01
    assert abs(center[1]) < 1e-6
    assert center[2] < 0.35


def _reach(shape, X_BG):
    """How far from the origin a shape gets, seen from above; boxes and lying cylinders by their bounding rectangle."""
    center = np.abs(X_BG.translation()[:2])
    upright = abs(X_BG.rotation().matrix()[2, 2]) > 0.999
    if isinstance(shape, Sphere) or (isinstance(shape, Cylinder) and upright):
        return np.linalg.norm(center) + shape.radius()
    if isinstance(shape, Cylinder):
        return np.linalg.norm(center + np.array([shape.radius(), 0.5 * shape.length()]))
    if isinstance(shape, Box):
        return np.linalg.norm(center + 0.5 * shape.size()[:2])
    assert isinstance(shape, Ellipsoid)
    return np.linalg.norm(center + np.array([shape.a(), shape.b()]))


def test_nothing_of_the_body_leaves_the_disc_seen_from_above(make_bench):
    bench = make_bench()
    plant, context = bench.plant, bench.plant_context
    inspector = plant.get_geometry_query_input_port().Eval(context).inspector()
    for body in map(plant.get_body, plant.GetBodyIndices(bench.robot.robot)):
        X_WB = plant.EvalBodyPoseInWorld(context, body)
        for geometry in (*plant.GetCollisionGeometriesForBody(body), *plant.GetVisualGeometriesForBody(body)):
            X_WG = X_WB @ inspector.GetPoseInFrame(geometry)
            name = inspector.GetName(geometry)
            assert _reach(inspector.GetShape(geometry), X_WG) <= NOMINAL.body_radius + 1e-9, name


def test_the_shoulder_is_where_the_kinematics_has_it(make_bench):
    bench = make_bench()
    shoulder = bench.plant.GetFrameByName("upper_arm", bench.robot.arm)
    p_BS = bench.plant.CalcRelativeTransform(bench.plant_context, bench.robot.base.body_frame(), shoulder).translation()
    assert p_BS == pytest.approx(SHOULDER)


def test_the_hull_is_the_geometry_that_bumps(make_bench):
    bench = make_bench()
    query = bench.plant.get_geometry_query_input_port().Eval(bench.plant_context)
    shape = query.inspector().GetShape(bench.robot.hull)
    assert isinstance(shape, Cylinder)
    assert shape.radius() == NOMINAL.body_radius


def test_the_robot_is_put_where_it_is_wanted_at_rest(make_bench):
    bench = make_bench()
    bench.drive(2.0, 0.0, 0.5, seconds=0.5)
    mut.SetRobotPose(bench.plant, bench.plant_context, bench.robot, x=3.0, y=-2.0, yaw=2.5)
    assert bench.state() == pytest.approx((3.0, -2.0, 2.5, 0.0, 0.0, 0.0), abs=1e-9)
    assert bench.plant_state()[LEFT_WHEEL_SPEED] == 0.0


def test_a_head_on_crash_stops_the_robot(make_bench):
    def add_crate(plant, scene_graph, robot):
        X_WC = RigidTransform([2.5, 0.0, 0.5])
        plant.RegisterCollisionGeometry(plant.world_body(), X_WC, Box(1, 1, 1), "crate", CoulombFriction(0.5, 0.5))

    bench = make_bench(add=add_crate)
    bench.drive(2.0, 0.0, 0.0, seconds=0.75)
    bench.drive(0.0, 0.0, 0.0, seconds=0.6)
    assert bench.state()[V_X] > 1.4
    farthest = 0.0
    for _ in range(50):
        bench.drive(0.5, 0.0, 0.0, seconds=0.04)
        farthest = max(farthest, bench.state()[X])
    assert farthest + NOMINAL.body_radius == pytest.approx(2.0, abs=0.03)
    assert abs(bench.state()[V_X]) < 0.05
    height = bench.plant.EvalBodyPoseInWorld(bench.plant_context, bench.robot.base).translation()[2]
    assert abs(height) < 0.02


def test_the_wheels_carry_the_robot_at_their_contact_points(make_bench):
    """Rolling without slipping, from Drake's own Jacobian: the contact point's velocity is zero."""
    bench = make_bench()
    bench.drive(1.0, 0.0, 0.3, seconds=1.0)
    plant, context = bench.plant, bench.plant_context
    wheel = plant.GetBodyByName("left_wheel", bench.robot.robot)
    X_WL = plant.EvalBodyPoseInWorld(context, wheel)
    p_LC = X_WL.rotation().inverse() @ np.array([0.0, 0.0, -NOMINAL.wheel_radius])
    world = plant.world_frame()
    J = plant.CalcJacobianTranslationalVelocity(context, JacobianWrtVariable.kV, wheel.body_frame(), p_LC, world, world)
    assert np.abs(J @ plant.GetVelocities(context))[:2].max() < 0.01


def test_the_face_is_there_to_be_seen(make_bench):
    bench = make_bench()
    query = bench.plant.get_geometry_query_input_port().Eval(bench.plant_context)
    inspector = query.inspector()
    names = {
        inspector.GetName(geometry).split("::")[-1]
        for geometry in bench.plant.GetVisualGeometriesForBody(bench.robot.base)
        if inspector.GetProperties(geometry, Role.kIllustration) is not None
    }
    assert {"screen", "left_eye", "right_eye", "mouth"} <= names
