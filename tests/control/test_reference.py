"""The virtual robot: it drives as a differential drive can, and ends at rest in the wanted pose."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.control import reference as mut
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.drive_path import make_drive_path
from mala_drake.ward.routes import Route
from mala_drake.ward.ward_map import Ward

EMPTY = Ward("empty", 50.0, 0.2, 2.0, (), (), (), 0.02)
PERIOD = 0.2


def track_through(points, target_yaw=0.0, *, reverse=False):
    return mut.Track(make_drive_path(Route(np.array(points, float)), Congestion(EMPTY)), target_yaw, reverse)


def roll(track, state, length=0.0, *, horizon=20, turning=False):
    turning = mut.needs_turn(track, state[2], length, turning=turning)
    return mut.make_reference(track, np.array(state, float), length, turning=turning, horizon=horizon, period=PERIOD)


@given(st.floats(-3.0, 3.0), st.floats(0.0, 1.4), st.floats(0.0, 9.0))
def test_the_reference_never_moves_sideways_while_it_drives(yaw, speed, length):
    states = roll(track_through([(0, 0), (5, 0), (5, 5)]), (0, 0, yaw, speed, 0, 0), length).states
    assert (states[:, 4] == 0).all()
    steps = np.hypot(*np.diff(states[:, :2], axis=0).T)
    means = 0.5 * (states[1:, 3] + states[:-1, 3]) * PERIOD
    # The chord across a rounded corner is shorter than the arc, never longer; the last step may end at the goal.
    assert (steps <= means + 1e-9).all()


@given(st.floats(-3.0, 3.0), st.floats(0.0, 1.4))
def test_speed_changes_within_the_accelerations_of_the_path(yaw, speed):
    speeds = roll(track_through([(0, 0), (8, 0)]), (0, 0, yaw, speed, 0, 0)).states[:, 3]
    assert (np.diff(speeds) <= mut.ACCELERATION * PERIOD + 1e-9).all()
    assert (np.diff(speeds) >= -mut.DECELERATION * PERIOD - 1e-9).all()


def test_it_ends_at_rest_in_the_target_pose():
    states = roll(track_through([(0, 0), (3, 0)], target_yaw=math.pi / 2), (0, 0, 0, 0, 0, 0), horizon=80).states
    assert states[-1, :2] == pytest.approx((3.0, 0.0))
    assert math.remainder(states[-1, 2] - math.pi / 2, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert states[-1, 3] == 0.0


def test_a_robot_that_looks_away_turns_on_the_spot_first():
    states = roll(track_through([(0, 0), (5, 0)]), (0, 0, math.pi * 0.9, 0, 0, 0)).states
    turning = np.abs([math.remainder(yaw, math.tau) for yaw in states[:, 2]]) > 0.5
    assert turning[0]
    assert (states[turning, 3] == 0).all()
    assert np.abs(np.diff(states[:, 2])).max() <= mut.TURN_RATE * PERIOD + 1e-9
    assert states[-1, 0] > 0.1


def test_a_short_way_back_is_driven_in_reverse():
    states = roll(track_through([(0, 0), (-0.5, 0)], reverse=True), (0, 0, 0, 0, 0, 0), horizon=40).states
    assert states[-1, 0] == pytest.approx(-0.5, abs=0.02)
    assert states[:, 3].min() < -0.1
    assert np.abs(states[:, 2]).max() == pytest.approx(0.0, abs=1e-9)


def test_progress_is_found_near_the_last_one_on_a_path_that_comes_back():
    track = track_through([(0, 0), (8, 0), (8, 0.6), (0, 0.6)])
    there, _ = track.progress(np.array([4.0, 0.3]), 3.8)
    back, _ = track.progress(np.array([4.0, 0.3]), track.path.length - 4.2)
    assert there == pytest.approx(4.0, abs=0.1)
    assert back == pytest.approx(track.path.length - 4.0, abs=0.1)


@given(st.lists(st.tuples(st.floats(-2.0, 7.0), st.floats(-2.0, 2.0)), min_size=2, max_size=20))
def test_progress_never_falls(positions):
    track = track_through([(0, 0), (5, 0), (0, 0.5)])
    length = 0.0
    for position in positions:
        further, distance = track.progress(np.array(position), length)
        assert length <= further <= track.path.length
        assert distance >= 0.0
        length = further


def test_a_reference_that_comes_to_rest_ends_there_and_one_that_does_not_stays_whole():
    track = track_through([(0, 0), (1, 0)], target_yaw=0.3)
    whole = roll(track, (0, 0, 0, 0, 0, 0), horizon=40)
    short = whole.until_rest(5)
    assert 5 < len(short.states) - 1 < 40
    np.testing.assert_array_equal(short.states, whole.states[: len(short.states)])
    np.testing.assert_allclose(short.states[-1], (1, 0, 0.3, 0, 0, 0), atol=1e-9)
    assert np.abs(short.states[-2] - short.states[-1]).max() > 1e-6
    moving = roll(track_through([(0, 0), (9, 0)]), (0, 0, 0, 1, 0, 0))
    assert moving.until_rest(5) is moving


def test_a_reference_already_at_rest_keeps_the_shortest_horizon():
    track = track_through([(0, 0), (1, 0)])
    at_goal = roll(track, (1, 0, 0, 0, 0, 0), length=1.0)
    assert len(at_goal.until_rest(5).states) == 6


def test_driven_as_planned_the_horizon_shrinks_by_a_stage_a_sample():
    track = track_through([(0, 0), (1, 0)])
    plan = roll(track, (0, 0, 0, 0, 0, 0), horizon=40).until_rest(1)
    stages = []
    for row in plan.states[:-1]:
        length, _ = track.progress(row[:2], 0.0)
        stages.append(len(roll(track, row, length, horizon=40).until_rest(1).states) - 1)
    assert stages[0] == len(plan.states) - 1
    assert max(abs(n - (stages[0] - k)) for k, n in enumerate(stages)) <= 1
