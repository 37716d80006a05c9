"""The way that the base has to move for the arm to reach, against the arm's own kinematics and a blind search."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.robot.arm_reach as mut
from mala_drake.robot.arm_kinematics import joints_for_gripper

heights = st.floats(0.75, 1.2)  # That the robot works at.
places = st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), heights)


def after(point, way):
    """The point in the base frame once the base has moved."""
    return point[0] - way[0], point[1] - way[1], point[2]


def just_inside(point, way):
    """A hair farther than the way, for rounding."""
    length = math.hypot(*way)
    return after(point, [part * (1 + 1e-6 / max(length, 1e-6)) for part in way])


@given(places)
def test_after_the_way_the_arm_reaches_and_where_it_does_already_there_is_none(point):
    way = mut.way_to_reach(point)
    if joints_for_gripper(point) is not None:
        assert way == mut.NO_WAY
    else:
        assert joints_for_gripper(just_inside(point, way)) is not None


@given(st.floats(1.0, 3.0), st.floats(-3.0, 3.0), heights, st.integers(0, 5))
def test_to_what_is_far_ahead_no_way_is_shorter(ahead, aside, height, seed):
    point = ahead, aside, height
    length = math.hypot(*mut.way_to_reach(point))
    generator = np.random.default_rng(seed)
    for angle, share in zip(generator.uniform(0, 2 * np.pi, 50), generator.uniform(0, 1, 50), strict=True):
        way = (length - 1e-6) * share * np.array([np.cos(angle), np.sin(angle)])
        if length > 1e-5:
            assert joints_for_gripper(after(point, way)) is None


def test_a_point_far_ahead_asks_for_what_is_missing_of_the_stretched_arm():
    height = 0.90
    reach = math.sqrt(1.12**2 - 0.10**2)
    ahead, aside = mut.way_to_reach((2.0 - 0.15, 0.0, height))
    assert ahead == 2.0 - reach
    assert aside == 0.0


def test_of_several_points_the_worst_counts():
    near, far = (1.2, 0.0, 0.9), (2.0, 0.5, 0.9)
    assert mut.way_to_reach_all([near, far]) == mut.way_to_reach(far)
    assert mut.way_to_reach_all([]) == mut.NO_WAY
