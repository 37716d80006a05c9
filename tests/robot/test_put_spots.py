import math

import pytest

import mala_drake.robot.put_spots as mut
from mala_drake.robot.gripper_geometry import landing_positions
from mala_drake.ward.items import ItemPose, all_items, return_spots, table_spots

AT_ORIGIN = (0.0, 0.0, 0.0)
MIDDLE = ItemPose(0.7, 0.0, 0.83)
LEFT = ItemPose(0.7, 0.3, 0.83)


def test_the_first_free_spot_is_taken():
    goal, reachable = mut.choose_spot([MIDDLE, LEFT], AT_ORIGIN, 0, [])
    assert reachable
    assert landing_positions(AT_ORIGIN, goal)[0][:2] == pytest.approx((0.7, 0.0))


@pytest.mark.parametrize("slot", [0, 1])
def test_a_spot_is_taken_only_if_there_is_room_under_both_pads(slot):
    landings = landing_positions(AT_ORIGIN, mut.work_goal((0.7, 0.0, 0.83), AT_ORIGIN, slot))
    for other in landings:
        goal, reachable = mut.choose_spot([MIDDLE, LEFT], AT_ORIGIN, slot, [other])
        assert reachable
        for landing in landing_positions(AT_ORIGIN, goal):
            assert math.dist(landing[:2], other[:2]) >= mut.CLEARANCE


def test_a_full_ledge_is_told_from_one_out_of_reach():
    assert mut.choose_spot([MIDDLE], AT_ORIGIN, 0, [(0.7, 0.0, 0.83)]) == (None, True)
    assert mut.choose_spot([MIDDLE], (-3.0, 0.0, 0.0), 0, []) == (None, False)
    assert mut.choose_spot([], AT_ORIGIN, 0, []) == (None, False)


def test_work_is_done_only_where_the_arm_gets_above_as_well():
    assert mut.work_goal((0.7, 0.0, 0.83), AT_ORIGIN, 0) is not None
    assert mut.work_goal((1.5, 0.0, 0.83), AT_ORIGIN, 0) is None
    assert mut.work_goal((-0.15, 0.0, 0.83), AT_ORIGIN, 0) is None
    assert mut.work_goal((math.nan, 0.0, 0.83), AT_ORIGIN, 0) is None


def displaced(place, ahead, aside, turn):
    cosine, sine = math.cos(place.yaw), math.sin(place.yaw)
    x, y = place.x + ahead * cosine - aside * sine, place.y + ahead * sine + aside * cosine
    return x, y, place.yaw + turn


ARRIVALS = [(0.15 * math.cos(a), 0.15 * math.sin(a), turn) for a in range(6) for turn in (-0.2, 0.0, 0.2)]


@pytest.mark.parametrize("arrival", ARRIVALS)
def test_all_work_is_within_reach_from_wherever_a_leg_may_end(ward, arrival):
    """A leg ends within 0.15 m and 0.2 rad of the standing pose."""
    items = all_items(ward)
    positions = [(item.shelf_pose.x, item.shelf_pose.y, item.shelf_pose.z) for item in items]
    for item, position in zip(items, positions, strict=True):
        base = displaced(ward.place[item.place], *arrival)
        assert mut.work_goal(position, base, 0 if item.kind.startswith("med_") else 1) is not None, item.name
    for place in ward.places:
        base = displaced(place, *arrival)
        spots = return_spots(ward, place.name, "")
        assert not spots or all(mut.choose_spot(spots, base, slot, positions)[0] for slot in (0, 1))
        if place.category == "bedside":
            goal, _ = mut.choose_spot(table_spots(ward, place.name), base, -1, positions)
            assert goal is not None
            table = ward.furniture_of[place.name].shape
            for x, y, _ in landing_positions(base, goal):
                dx, dy = x - table.x, y - table.y
                along = math.cos(table.yaw) * dx + math.sin(table.yaw) * dy
                across = math.cos(table.yaw) * dy - math.sin(table.yaw) * dx
                assert abs(along) < table.half_length - 0.02
                assert abs(across) < table.half_width - 0.02


@pytest.mark.parametrize("base", [(-2.0, 0.3, 0.2), (0.5, -1.4, 0.0), (1.1, 1.9, -1.0)])
@pytest.mark.parametrize("slot", [0, 1, -1])
def test_the_way_to_work_ends_where_it_can_be_done(base, slot):
    center = (0.7, 0.0, 0.83)
    ahead, aside = mut.way_to_work(center, base, slot)
    cosine, sine = math.cos(base[2]), math.sin(base[2])

    def moved(share):
        x, y = cosine * ahead - sine * aside, sine * ahead + cosine * aside
        return base[0] + share * x, base[1] + share * y, base[2]

    off = 0.04 / math.hypot(ahead, aside)
    assert mut.work_goal(center, moved(1.0 - off), slot) is None
    assert mut.work_goal(center, moved(1.0 + off), slot) is not None


def test_the_nearest_of_several_spots_counts():
    base = (-2.0, 0.0, 0.0)
    assert mut.way_to_spots([LEFT, MIDDLE], base, 0) == mut.way_to_spots([MIDDLE], base, 0)
    assert mut.way_to_spots([], base, 0) == mut.NO_WAY
