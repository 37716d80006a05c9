"""The gripper's motion and its Jacobian's transpose, against the plant's own multibody kinematics."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RollPitchYaw
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import DiagramBuilder

from mala_drake.robot import gripper_motion as mut
from mala_drake.robot.arm_kinematics import PAD_OFFSETS
from mala_drake.robot.plant import AddCareRobot, MakeCarePlant

small = st.floats(-0.2, 0.2)
rates = st.tuples(*[st.floats(-1.5, 1.5)] * 9)
joint_angles = st.tuples(st.floats(-1.5, 1.5), st.floats(-0.9, 2.1), st.floats(-2.7, 0.0))
vectors = st.tuples(*[st.floats(-5.0, 5.0)] * 3)
poses = st.tuples(small, small, st.floats(-3.1, 3.1), st.floats(-9.0, 9.0), st.floats(-9.0, 9.0))


@pytest.fixture(scope="module")
def truth():
    builder = DiagramBuilder()
    plant, scene_graph = MakeCarePlant(builder)
    robot = AddCareRobot(plant, scene_graph)
    plant.Finalize()
    return plant, robot, plant.CreateDefaultContext()


def _set(truth, pose, joints, velocities):
    """Sets the plant; returns the base's state as the plant has it, the quaternion's norm spoilt."""
    plant, robot, context = truth
    roll, pitch, yaw, x, y = pose
    quaternion = RollPitchYaw(roll, pitch, yaw).ToQuaternion().wxyz()
    base_positions = [*(1.03 * quaternion), x, y, 0.01]
    plant.SetPositions(context, robot.robot, [*base_positions, 0.0, 0.0])
    plant.SetVelocities(context, robot.robot, [*velocities[:6], 0.0, 0.0])
    plant.SetPositions(context, robot.arm, joints)
    plant.SetVelocities(context, robot.arm, velocities[6:])
    return [*base_positions, *velocities[:6]]


@given(pose=poses, joints=joint_angles, velocities=rates, pad=st.sampled_from([0, 1]))
def test_pads_move_as_in_the_plant(truth, pose, joints, velocities, pad):
    base = _set(truth, pose, joints, velocities)
    _, robot, context = truth
    motion = mut.gripper_motion(base, joints, velocities[6:])

    X_WG = robot.gripper.CalcPoseInWorld(context)
    p_WP = X_WG @ np.array([0.0, PAD_OFFSETS[pad], 0.0])
    assert motion.pad_position(pad) == pytest.approx(p_WP, abs=1e-9)
    V_WG = robot.gripper.CalcSpatialVelocityInWorld(context)
    assert motion.velocity_at(motion.pad_position(pad)) == pytest.approx(
        V_WG.Shift(p_WP - X_WG.translation()).translational(), abs=1e-9
    )
    bar = X_WG.rotation().matrix()[:, 1]
    assert motion.yaw == pytest.approx(math.atan2(-bar[0], bar[1]), abs=1e-9)


@given(pose=poses, joints=joint_angles, torque=vectors, force=vectors, offset=vectors)
def test_a_wrench_on_the_gripper_has_the_generalized_force_of_the_plants_jacobian(
    truth, pose, joints, torque, force, offset
):
    base = _set(truth, pose, joints, (0.0,) * 9)
    plant, robot, context = truth
    motion = mut.gripper_motion(base, joints, (0.0,) * 3)
    point = np.array(motion.gripper) + 0.02 * np.array(offset)
    on_base, on_joints = motion.generalized_force(tuple(point), torque, force)

    p_GQ = robot.gripper.CalcPoseInWorld(context).inverse() @ point
    world = plant.world_frame()
    J = plant.CalcJacobianSpatialVelocity(context, JacobianWrtVariable.kV, robot.gripper, p_GQ, world, world)
    expected = J.T @ np.array([*torque, *force])
    start = robot.base.floating_velocities_start_in_v()
    assert on_base == pytest.approx(expected[start : start + 6], abs=1e-9)
    assert on_joints == pytest.approx(plant.GetVelocitiesFromArray(robot.arm, expected), abs=1e-9)


def test_yaw_rate_is_that_of_base_and_shoulder(truth):
    motion = mut.gripper_motion([1.0] + [0.0] * 8 + [0.4, 0.0, 0.0, 0.0], (0.0, 0.0, -1.0), (0.25, 3.0, 3.0))
    assert motion.yaw_rate == pytest.approx(0.65)
