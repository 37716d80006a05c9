"""The arm's way from goal to goal: smooth, and never back to where it has just come from."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.robot import arm_motion as mut
from mala_drake.robot.arm_kinematics import STOWED, gripper_position, joints_for_gripper
from mala_drake.robot.joint_motion import MAX_ACCELERATION, MAX_SPEED

angles = st.tuples(st.floats(-1.5, 1.5), st.floats(-1.0, 2.0), st.floats(-2.5, 0.0))


BEGIN = 100.0
"""Seconds; long after any motion that began at 0."""


def _first(start, goal):
    """A motion from rest at `start`, which begins at `BEGIN`."""
    return mut.ArmMotion().redirected(0.0, start).redirected(BEGIN, goal)


def _share(motion, share):
    return BEGIN + share * (motion.end_time - BEGIN)


@given(start=angles, goal=angles, other=angles, share=st.floats(0.0, 1.2))
def test_a_change_of_mind_makes_no_jump(start, goal, other, share):
    first = _first(start, goal)
    time = _share(first, share)
    second = first.redirected(time, other)
    for was, becomes in zip(first.at(time), second.at(time), strict=True):
        assert becomes == pytest.approx(was, abs=1e-6)
    turning = second.going.start_time
    assert turning >= time
    if turning - time > 1e-3:
        for before, after in zip(second.at(turning - 1e-7), second.at(turning), strict=True):
            assert after == pytest.approx(before, abs=1e-2)
    assert second.at(second.end_time + 1e-6) == (other, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@given(start=angles, goal=angles, other=angles, share=st.floats(0.0, 1.2))
def test_no_joint_goes_beyond_where_it_stops_to_turn(start, goal, other, share):
    first = _first(start, goal)
    time = _share(first, share)
    second = first.redirected(time, other)
    position, velocity, _ = first.at(time)
    stop = second.at(second.going.start_time)[0]
    path = np.array([second.at(t)[0] for t in np.linspace(time, second.end_time, 200)])
    corners = np.array([position, stop, other])
    # An accelerating joint is a trifle past its stop before it rests there.
    slack = 0.02 * np.abs(stop - np.array(position)).max() + 1e-6
    assert (path >= corners.min(axis=0) - slack).all()
    assert (path <= corners.max(axis=0) + slack).all()
    braking = 1.5 * max(np.abs(velocity)) / MAX_ACCELERATION
    assert second.going.start_time - time <= braking + 1e-9
    assert np.abs(np.array(stop) - position).max() <= braking * MAX_SPEED + 1e-9


def test_from_rest_it_leaves_at_once():
    motion = mut.ArmMotion().redirected(2.0, (0.3, 1.0, -1.0))
    assert motion.going.start_time == 2.0
    assert motion.at(2.0)[0] == STOWED


@pytest.mark.parametrize("lead", [0.02, 0.08, 0.15])
def test_an_arm_sent_home_at_the_end_of_a_lift_does_not_dip_again(lead):
    """The two carried boxes would be pressed on the ledge that the gripper has just left."""
    low, high = (joints_for_gripper((0.66, 0.52, z)) for z in (0.90, 0.98))
    assert low is not None
    assert high is not None
    lift = mut.ArmMotion().redirected(0.0, low).redirected(10.0, high)
    time = lift.end_time - lead
    home = lift.redirected(time, STOWED)
    height = gripper_position(lift.at(time)[0])[2]
    first_second = np.linspace(time, time + 1.0, 100)
    assert min(gripper_position(home.at(t)[0])[2] for t in first_second) >= height - 1e-6
