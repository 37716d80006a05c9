"""How a leg goes on and ends, without physics: every rule on its own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from mala_drake.clock import TICK
from mala_drake.control import leg as mut
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.reference import make_reference
from mala_drake.messages import Outcome, Shape
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.legs import LegPlanner
from mala_drake.ward.ward_map import Furniture, Ward

TARGET = (6.0, 0.0, 0.0)


def make_guide(*furniture, rules=None):
    ward = Ward("hall", 10.0, 0.2, 2.0, (), furniture, (), 0.02)
    return mut.LegGuide(LegPlanner(ward), Congestion(ward), ward.shapes, rules or mut.LegRules())


def at(x=0.0, y=0.0, yaw=0.0, speed=0.0, yaw_rate=0.0):
    return np.array([x, y, yaw, speed, 0.0, yaw_rate])


def test_success_needs_place_direction_and_rest():
    guide = make_guide()
    leg = guide.begin(TARGET, at(), ())
    assert guide.advance(leg, at(6.0, 0.05, 0.05), ()).outcome is Outcome.SUCCESS
    for almost in (at(6.0, 0.2), at(6.0, 0.0, 0.3), at(6.0, 0.0, 0.0, 0.2), at(6.0, 0.0, 0.0, 0.0, 0.2)):
        assert guide.advance(leg, almost, ()).outcome is Outcome.RUNNING


def test_the_reference_follows_the_track_and_shrinks_to_its_end_if_it_is_to():
    leg, problem = make_guide().begin(TARGET, at(), ()), OptimalControlProblem(horizon=40)
    whole = leg.reference(at(), problem, None).states
    np.testing.assert_array_equal(
        whole, make_reference(leg.track, at(), 0.0, turning=False, horizon=40, period=TICK).states
    )
    assert whole[-1, :2] == pytest.approx(TARGET[:2])
    short = leg.reference(at(), problem, 5).states
    assert 6 < len(short) < len(whole) == 41
    np.testing.assert_array_equal(short, whole[: len(short)])


def test_the_step_budget_ends_a_leg():
    guide = make_guide(rules=mut.LegRules(step_budget=3))
    leg = guide.begin(TARGET, at(), ())
    for i in range(3):
        leg = guide.advance(leg, at(0.1 * i, speed=0.5), ())
    assert leg.outcome is Outcome.STEP_BUDGET


def test_the_allocation_of_a_waypoint_ends_a_leg_that_does_not_get_there():
    guide = make_guide(rules=mut.LegRules(waypoint_iterations=5))
    leg = guide.begin(TARGET, at(), ())
    for _ in range(5):
        leg = guide.advance(leg, at(0.3, speed=0.5), ())
    assert leg.outcome is Outcome.WAYPOINT_ALLOCATION


def test_reaching_waypoints_renews_the_allocation():
    guide = make_guide(rules=mut.LegRules(waypoint_iterations=12))
    leg = guide.begin(TARGET, at(), ())
    for i in range(50):
        leg = guide.advance(leg, at(0.15 * min(i, 36), speed=0.75), ())
        if i == 30:
            assert leg.outcome is Outcome.RUNNING
    assert leg.outcome is Outcome.WAYPOINT_ALLOCATION  # It stopped advancing at x = 5.4.


def test_an_obstacle_in_the_way_is_driven_round():
    guide = make_guide()
    leg = guide.begin(TARGET, at(), ())
    trolley = Shape("trolley", 3.0, 0.0, 0.0, 0.5, 0.5)
    after = guide.advance(leg, at(0.5, speed=1.0), (trolley,))
    assert after.outcome is Outcome.RUNNING
    assert after.track is not leg.track
    nearest = mut.ShapeDistances([trolley])(after.track.path.points).min()
    assert nearest > mut.BODY_RADIUS
    assert after.unmapped == (trolley,)


def test_an_obstacle_beside_the_way_changes_nothing():
    guide = make_guide()
    leg = guide.begin(TARGET, at(), ())
    after = guide.advance(leg, at(0.5, speed=1.0), (Shape("trolley", 3.0, 4.0, 0.0, 0.5, 0.5),))
    assert after.track is leg.track


def test_a_way_without_a_gap_is_blocked():
    wall = Furniture("wall", "partition", 3.0, 5.5, 2.0, half_length=0.1, half_width=4.5)
    other = Furniture("other", "partition", 3.0, -5.5, 2.0, half_length=0.1, half_width=4.5)
    guide = make_guide(wall, other)
    leg = guide.begin(TARGET, at(), ())
    assert leg.outcome is Outcome.RUNNING
    after = guide.advance(leg, at(0.5, speed=1.0), (Shape("trolley", 3.0, 0.0, 0.0, 0.5, 0.9),))
    assert after.outcome is Outcome.BLOCKED
    assert "trolley" in after.detail


def test_a_robot_found_elsewhere_gets_a_new_path_from_there():
    guide = make_guide()
    leg = guide.begin(TARGET, at(), ())
    moved = guide.advance(leg, at(2.0, 3.0), ())
    assert moved.track is not leg.track
    assert moved.track.path.points[0] == pytest.approx((2.0, 3.0))


def test_a_robot_that_stands_beside_its_target_approaches_again_and_then_gives_up():
    guide = make_guide(rules=mut.LegRules(approaches=2, waypoint_iterations=1000))
    leg = replace(guide.begin(TARGET, at(5.0), ()), length=1.0)
    beside = at(6.0, 0.3)
    for _ in range(10):
        leg = guide.advance(leg, beside, ())
    assert leg.approaches == 2
    assert leg.track.path.length == pytest.approx(0.3, abs=0.05)
    for _ in range(10):
        leg = guide.advance(leg, beside, ())
    assert leg.outcome is Outcome.WAYPOINT_ALLOCATION


def test_an_overshot_target_is_crept_back_to():
    guide = make_guide()
    leg = guide.begin(TARGET, at(6.4, 0.0, 0.0), ())
    assert leg.track.reverse


def test_pose_errors_wrap_the_yaw():
    position, yaw = mut.pose_errors(at(1.0, 1.0, math.pi - 0.1), (1.0, 2.0, -math.pi + 0.1))
    assert position == pytest.approx(1.0)
    assert yaw == pytest.approx(0.2)
