"""The arm's closed-form kinematics, against the plant's own forward kinematics."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pydrake.systems.framework import DiagramBuilder

from mala_drake.robot import arm_kinematics as mut
from mala_drake.robot.plant import ARM_JOINTS, AddCareRobot, MakeCarePlant
from mala_drake.robot.robot_parameters import NOMINAL
from mala_drake.ward.items import ITEM_SIZE

joint_angles = st.tuples(st.floats(-1.5, 1.5), st.floats(-0.9, 2.1), st.floats(-2.7, 0.0))
pads = st.sampled_from([0, 1])


@pytest.fixture(scope="module")
def arm():
    """The plant's own kinematics: a callable from joint angles to the pose of the gripper in the base frame."""
    builder = DiagramBuilder()
    plant, scene_graph = MakeCarePlant(builder)
    robot = AddCareRobot(plant, scene_graph)
    plant.Finalize()
    context = plant.CreateDefaultContext()

    def pose(joints):
        plant.SetPositions(context, robot.arm, np.array(joints))
        return plant.CalcRelativeTransform(context, robot.base.body_frame(), robot.gripper)

    pose.plant, pose.robot = plant, robot
    return pose


@given(joints=joint_angles)
def test_forward_kinematics_are_those_of_the_plant(arm, joints):
    assert mut.gripper_position(joints) == pytest.approx(arm(joints).translation(), abs=1e-12)


@given(joints=joint_angles, pad=pads)
def test_pads_lie_along_the_bar_of_the_plant(arm, joints, pad):
    X_BG = arm(joints)
    expected = X_BG @ np.array([0.0, mut.PAD_OFFSETS[pad], 0.0])
    assert mut.pad_position(joints, pad) == pytest.approx(expected, abs=1e-12)


@given(joints=joint_angles)
def test_inverse_kinematics_find_the_joints_again(joints):
    r = math.hypot(*(np.array(mut.gripper_position(joints)[:2]) - mut.SHOULDER[:2]))
    # Behind its axis the shoulder turns round instead of leaning back; stretched out, the angles are ill posed.
    in_front = math.cos(joints[1]) + math.cos(joints[1] + joints[2]) > 0.0
    assume(in_front and r > 0.05 and joints[2] < -0.01)
    assert mut.joints_for_gripper(mut.gripper_position(joints)) == pytest.approx(joints, abs=1e-6)


@given(p_BG=st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.floats(0.0, 2.5)))
def test_a_solution_reaches_the_point_and_keeps_the_limits(arm, p_BG):
    joints = mut.joints_for_gripper(p_BG)
    distance = math.dist(p_BG, mut.SHOULDER)
    if joints is None:
        in_front = p_BG[0] > mut.SHOULDER[0] + 0.2 and abs(math.atan2(p_BG[2] - 0.8, p_BG[0] - mut.SHOULDER[0])) < 0.5
        assert distance > 2.0 * mut.LINK_LENGTH or not in_front or distance < 0.3
        return
    assert arm(joints).translation() == pytest.approx(p_BG, abs=1e-9)
    for name, angle in zip(ARM_JOINTS, joints, strict=True):
        joint = arm.plant.GetJointByName(name, arm.robot.arm)
        assert joint.position_lower_limit() <= angle <= joint.position_upper_limit()


@pytest.mark.parametrize(
    "p_BG", [(1.5, 0.0, 0.9), (0.5, 0.0, 2.5), (math.nan, 0.0, 0.9), (math.inf, 0.0, 0.9), mut.SHOULDER]
)
def test_points_out_of_reach_have_no_solution(p_BG):
    assert mut.joints_for_gripper(p_BG) is None


@given(distance=st.floats(0.4, 0.9), bearing=st.floats(-1.2, 1.2), height=st.floats(0.6, 1.1))
@settings(max_examples=300)
def test_the_whole_working_space_is_within_reach(distance, bearing, height):
    assert mut.joints_for_gripper((distance * math.cos(bearing), distance * math.sin(bearing), height)) is not None


@given(x=st.floats(0.2, 0.7), y=st.floats(-0.5, 0.5), z=st.floats(0.6, 1.1), pad=pads)
def test_a_pad_gets_where_it_is_wanted(x, y, z, pad):
    joints = mut.joints_for_gripper(mut.gripper_for_pad((x, y, z), pad))
    assert joints is not None
    assert mut.pad_position(joints, pad) == pytest.approx((x, y, z), abs=1e-9)


def test_a_pad_cannot_be_in_the_shoulder():
    with pytest.raises(ValueError, match="too near"):
        mut.gripper_for_pad((mut.SHOULDER[0], 0.01, 1.0), 0)


def test_the_stowed_arm_and_what_it_carries_stay_above_the_deck_and_within_the_disc(arm):
    arm(mut.STOWED)
    plant, robot = arm.plant, arm.robot
    context = plant.CreateDefaultContext()
    elbow = plant.GetFrameByName("forearm", robot.arm)
    p_BE = plant.CalcRelativeTransform(context, robot.base.body_frame(), elbow).translation()
    assert math.hypot(*p_BE[:2]) + 0.04 < NOMINAL.body_radius
    for pad in (0, 1):
        p_BP = np.array(mut.pad_position(mut.STOWED, pad))
        farthest_corner = np.abs(p_BP[:2]) + 0.5 * np.array(ITEM_SIZE[:2])
        assert np.linalg.norm(farthest_corner) < NOMINAL.body_radius
        assert p_BP[2] - mut.PAD_RADIUS - ITEM_SIZE[2] > 0.76
