import itertools
import math

import numpy as np
import pytest
import shapely

import mala_drake.ward.legs as mut
from mala_drake.messages import Shape
from mala_drake.ward.congestion import Congestion, sample
from mala_drake.ward.drive_path import make_drive_path
from mala_drake.ward.routes import BODY_RADIUS
from mala_drake.ward.shapes import ShapeDistances, outline
from mala_drake.ward.ward_map import LoadWard

CLEARANCE = 0.1  # Metres between the body and anything solid, on every leg.


@pytest.fixture(scope="module")
def planner(ward):
    return mut.leg_planner(ward)


@pytest.fixture(scope="module")
def legs(ward, planner):
    return {(a, b): planner.between(a, b) for a, b in itertools.permutations(ward.place, 2)}


def end_direction(route):
    step = route.points[-1] - route.points[-2]
    return math.atan2(step[1], step[0])


def test_every_leg_leads_from_place_to_place(ward, legs):
    for (a, b), route in legs.items():
        assert route is not None, f"no way from {a} to {b}"
        assert route.points[0] == pytest.approx([ward.place[a].x, ward.place[a].y])
        assert route.points[-1] == pytest.approx([ward.place[b].x, ward.place[b].y])


def test_every_leg_is_drivable_without_contact(ward, legs):
    distances, congestion = ShapeDistances(ward.shapes), Congestion(ward)
    for leg, route in legs.items():
        assert distances(sample(route.points)[0]).min() >= BODY_RADIUS + CLEARANCE - 1e-6, leg
        driven = make_drive_path(route, congestion).points
        assert distances(sample(driven)[0]).min() >= BODY_RADIUS + CLEARANCE, leg


def test_at_least_half_of_the_legs_have_something_real_in_the_way(ward, legs):
    solid = shapely.union_all([outline(piece.shape) for piece in ward.furniture])
    blocked = 0
    for a, b in legs:
        ends = [(ward.place[name].x, ward.place[name].y) for name in (a, b)]
        blocked += shapely.LineString(ends).buffer(BODY_RADIUS).intersects(solid)
    assert blocked >= len(legs) / 2


def test_the_risk_of_every_leg_lies_between_zero_and_one(ward, legs):
    congestion = Congestion(ward)
    assert all(0.0 < congestion.risk(route.points) < 1.0 for route in legs.values())


def test_places_with_room_in_front_are_driven_into_straight(ward, legs):
    for name in ("pharmacy_north", "pharmacy_south", "supply_A", "supply_B", "charge_main", "charge_backup", "pantry"):
        yaw = ward.place[name].yaw
        for (_, goal), route in legs.items():
            if goal == name:
                assert abs(math.remainder(end_direction(route) - yaw, math.tau)) < 0.01


def test_a_leg_is_never_much_longer_than_the_shortest_route(ward, planner, legs):
    for (a, b), route in legs.items():
        start, goal = ((ward.place[name].x, ward.place[name].y) for name in (a, b))
        assert route.length >= math.dist(start, goal) - 1e-9
        shortest = planner._planner.route(start, goal).length
        assert shortest - 1e-9 <= route.length <= shortest + 2.0


def test_who_is_there_already_has_only_the_direction_left(planner):
    route = planner.to_pose((1.0, 2.0), (1.0, 2.0, 0.5))
    assert route.length < 0.01
    assert end_direction(route) == pytest.approx(0.5)


def test_a_trolley_in_the_way_is_gone_round(ward, planner, legs):
    straight = legs["home", "supply_A"]
    middle = straight.points[0] + 0.5 * (straight.points[1] - straight.points[0])
    trolley = Shape("trolley", float(middle[0]), float(middle[1]), half_length=0.6, half_width=0.35)
    supply = ward.place["supply_A"]
    around = planner.to_pose((0.0, 0.0), (supply.x, supply.y, supply.yaw), unmapped=[trolley])
    assert ShapeDistances([trolley])(sample(straight.points)[0]).min() < 0.0
    assert ShapeDistances([trolley])(sample(around.points)[0]).min() >= BODY_RADIUS + CLEARANCE - 1e-6


def test_one_ward_has_one_planner(ward):
    assert mut.leg_planner(ward) is mut.leg_planner(LoadWard())


def test_legs_are_the_same_each_time(ward, legs):
    again = mut.LegPlanner(ward).between("home", "patient_bed_right")
    assert np.array_equal(again.points, legs["home", "patient_bed_right"].points)
