import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.robot.gripper_geometry as mut
from mala_drake.robot.arm_kinematics import STOWED, joints_for_gripper

bases = st.tuples(st.floats(-20, 20), st.floats(-20, 20), st.floats(-7, 7))
points = st.tuples(st.floats(-20, 20), st.floats(-20, 20), st.floats(0, 2))
reachable = st.tuples(st.floats(0.45, 0.8), st.floats(-0.3, 0.3), st.floats(0.78, 0.95))
slots = st.sampled_from([0, 1])


@given(point=points, base=bases)
def test_into_the_base_and_back_is_the_same_point(point, base):
    assert mut.in_world(mut.in_base(point, base), base) == pytest.approx(point, abs=1e-9)


@given(point=points, base=bases)
def test_the_base_frame_keeps_distances(point, base):
    x, y, z = mut.in_base(point, base)
    assert math.hypot(x, y) == pytest.approx(math.dist(point[:2], base[:2]))
    assert z == point[2]


def test_the_base_frame_looks_ahead_and_to_the_left():
    base = (1.0, 2.0, math.pi / 2)
    assert mut.in_base((1.0, 3.0, 0.5), base) == pytest.approx((1.0, 0.0, 0.5))
    assert mut.in_base((0.0, 2.0, 0.5), base) == pytest.approx((0.0, 1.0, 0.5))


@given(box=reachable, base=bases, slot=slots)
def test_the_box_hangs_where_the_gripper_was_sent_for(box, base, slot):
    center = mut.in_world(box, base)
    p_BG = mut.gripper_to_hang_at(center, base, slot)
    joints = joints_for_gripper(p_BG)
    assert mut.hanging_positions(base, joints)[slot] == pytest.approx(center, abs=1e-9)
    assert mut.landing_positions(base, p_BG)[slot] == pytest.approx(center, abs=1e-9)


@given(box=reachable, base=bases)
def test_a_pair_hangs_on_both_sides_of_its_middle(box, base):
    center = mut.in_world(box, base)
    first, second = mut.landing_positions(base, mut.gripper_to_hang_at(center, base, -1))
    assert [(a + b) / 2 for a, b in zip(first, second, strict=True)] == pytest.approx(center, abs=1e-9)
    assert math.dist(first, second) == pytest.approx(0.14)


def test_stowed_boxes_hang_above_the_deck_within_the_hull():
    for x, y, z in mut.hanging_positions((0.0, 0.0, 0.0), STOWED):
        assert math.hypot(x, y) < 0.28
        assert z > 0.75


def test_what_is_out_of_reach_has_no_landing():
    assert mut.landing_positions((0.0, 0.0, 0.0), (3.0, 0.0, 0.9)) is None


def test_a_pad_does_not_get_onto_the_axis_of_the_arm():
    assert mut.gripper_to_hang_at((-0.15, 0.0, 0.9), (0.0, 0.0, 0.0), 0) is None
