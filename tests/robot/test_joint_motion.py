"""The joints' motion: its ends, its derivatives and its limits."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.robot import joint_motion as mut

angles = st.tuples(st.floats(-1.5, 1.5), st.floats(-1.0, 2.0), st.floats(-2.5, 0.0))


def _from_rest(start, goal, *, time=3.0):
    return mut.JointMotion(goal=start).redirected(time, goal)


@given(start=angles, goal=angles)
def test_it_starts_and_ends_at_rest(start, goal):
    motion = _from_rest(start, goal)
    zero = pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert motion.at(3.0)[0] == pytest.approx(start)
    assert motion.at(3.0)[1] == motion.at(3.0)[2] == zero
    just_before = motion.at(3.0 + motion.duration * (1.0 - 1e-9))
    assert just_before[0] == pytest.approx(goal, abs=1e-6)
    assert just_before[1] == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)
    assert motion.at(1e3) == (goal, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@given(start=angles, goal=angles)
def test_from_rest_it_keeps_the_limits_and_uses_one_of_them(start, goal):
    motion = _from_rest(start, goal)
    samples = [motion.at(3.0 + s * motion.duration) for s in np.linspace(0.0, 0.999, 400)]
    speed = max((np.abs(velocity).max() for _, velocity, _ in samples), default=0.0)
    acceleration = max(np.abs(acceleration).max() for _, _, acceleration in samples)
    assert speed <= mut.MAX_SPEED * (1 + 1e-6)
    assert acceleration <= mut.MAX_ACCELERATION * (1 + 1e-6)
    if max(abs(a - b) for a, b in zip(start, goal, strict=True)) > 1e-3:
        assert speed > 0.99 * mut.MAX_SPEED or acceleration > 0.99 * mut.MAX_ACCELERATION


@given(start=angles, goal=angles, other=angles, share=st.floats(0.0, 1.0), later=st.floats(0.05, 0.9))
def test_velocity_and_acceleration_are_the_derivatives(start, goal, other, share, later):
    first = _from_rest(start, goal)
    motion = first.redirected(3.0 + share * first.duration, other)
    if motion.duration < 1e-2:
        return
    time, step = motion.start_time + later * motion.duration, 1e-6 * motion.duration
    before, now, after = (motion.at(time + k * step) for k in (-1, 0, 1))
    velocity = (np.array(after[0]) - before[0]) / (2 * step)
    acceleration = (np.array(after[1]) - before[1]) / (2 * step)
    assert now[1] == pytest.approx(velocity, rel=1e-5, abs=1e-4)
    assert now[2] == pytest.approx(acceleration, rel=1e-5, abs=1e-3)


@given(start=angles, goal=angles, other=angles, share=st.floats(0.0, 1.2))
def test_a_change_of_mind_makes_no_jump(start, goal, other, share):
    first = _from_rest(start, goal)
    time = 3.0 + share * first.duration
    second = first.redirected(time, other)
    for was, becomes in zip(first.at(time), second.at(time), strict=True):
        assert becomes == pytest.approx(was, abs=1e-9)
    assert second.at(time + second.duration + 1e-6)[0] == other


def test_no_distance_takes_no_time():
    motion = _from_rest((0.1, 0.2, -0.3), (0.1, 0.2, -0.3))
    assert motion.duration == 0.0
    assert motion.at(3.0)[0] == (0.1, 0.2, -0.3)


def test_a_copy_is_the_motion_itself():
    motion = _from_rest((0.0, 1.0, -1.0), (0.5, 1.0, -1.0))
    assert copy.deepcopy(motion) is motion
