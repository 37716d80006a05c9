import math

import numpy as np
import pytest

import mala_drake.ward.displacement as mut
from mala_drake.errors import BadInput
from mala_drake.messages import Shape
from mala_drake.ward.items import all_items, table_spots, work_spot
from mala_drake.ward.routes import GOAL_DISTANCE, RoutePlanner
from mala_drake.ward.shapes import ShapeDistances
from mala_drake.ward.ward_map import LoadWard

WARD = LoadWard()
MOVES = {"pantry": (-1.5, -1.0), "patient_bed_left": (-1.2, -0.9)}


def test_only_displaced_places_and_what_serves_them_move():
    true = mut.displaced_ward(WARD, MOVES)
    for before, after in zip(WARD.places, true.places, strict=True):
        dx, dy = MOVES.get(before.name, (0.0, 0.0))
        assert (after.x, after.y, after.yaw) == (before.x + dx, before.y + dy, before.yaw)
    for before, after in zip(WARD.furniture, true.furniture, strict=True):
        dx, dy = MOVES.get(before.serves, (0.0, 0.0))
        assert (after.x, after.y, after.yaw) == (before.x + dx, before.y + dy, before.yaw)
    assert (true.zones, true.half_extent, true.walls) == (WARD.zones, WARD.half_extent, WARD.walls)


def test_boxes_and_tables_move_along():
    true = mut.displaced_ward(WARD, MOVES)
    for before, after in zip(all_items(WARD), all_items(true), strict=True):
        expected = np.add((before.shelf_pose.x, before.shelf_pose.y), MOVES.get(before.place, (0.0, 0.0)))
        np.testing.assert_allclose((after.shelf_pose.x, after.shelf_pose.y), expected)
        assert (after.name, after.shelf_pose.z, after.shelf_pose.yaw) == (
            before.name,
            before.shelf_pose.z,
            before.shelf_pose.yaw,
        )
    (before, *_), (after, *_) = (table_spots(ward, "patient_bed_left") for ward in (WARD, true))
    assert math.dist((after.x, after.y), (before.x, before.y)) == pytest.approx(1.5)
    assert work_spot(true, "stove") == work_spot(WARD, "stove")


def test_without_displacements_the_ward_is_its_map():
    assert mut.displaced_ward(WARD, {}) is WARD


def test_a_place_that_is_not_on_the_map_is_refused():
    with pytest.raises(BadInput, match=r"displaced place.*'attic'.*pantry"):
        mut.displaced_ward(WARD, {"attic": (1.0, 0.0)})


DRAWN = ("pantry", "prep_station", "quality_check", "patient_bed_left")


@pytest.mark.parametrize("seed", range(5))
def test_drawn_places_are_as_far_away_as_asked_and_the_robot_can_stand_there(seed):
    drawn = mut.draw_displacements(WARD, DRAWN, np.random.default_rng(seed))
    assert tuple(drawn) == DRAWN
    assert all(1.5 <= math.hypot(*by) <= 4.0 for by in drawn.values())
    true = mut.displaced_ward(WARD, drawn)
    for ward in (WARD, true):
        distances = ShapeDistances(ward.shapes)
        routes = RoutePlanner(ward.shapes)
        for name in DRAWN:
            for place in (true.place[name], WARD.place[name]):
                assert distances((place.x, place.y)).min() >= GOAL_DISTANCE
                assert routes.route((0.0, 0.0), (place.x, place.y)) is not None


def test_another_seed_displaces_otherwise_and_the_same_one_alike():
    drawn = [mut.draw_displacements(WARD, DRAWN, np.random.default_rng(seed)) for seed in (0, 1, 0)]
    assert drawn[0] == drawn[2] != drawn[1]


def test_what_is_told_stays_and_is_allowed_for():
    told = {"stove": (0.0, -2.5)}
    drawn = mut.draw_displacements(WARD, ("pantry",), np.random.default_rng(0), told=told)
    assert list(drawn) == ["stove", "pantry"]
    assert drawn["stove"] == told["stove"]


def test_a_place_for_which_there_is_no_room_is_refused():
    filled = Shape("sand", -3.0, 15.0, half_length=9.0, half_width=9.0)
    with pytest.raises(BadInput, match=r"displaced place: 'pantry'.*room"):
        mut.draw_displacements(WARD, ("pantry",), np.random.default_rng(0), [filled])


def test_a_place_that_is_taken_is_told_with_what_stands_there():
    assert mut.taken_place(WARD, {}) is None
    place, shape = mut.taken_place(WARD, {"pantry": (1.5, 0.0)})
    assert (place.name, shape.name) == ("pantry", "pantry_shelf")


def test_displaced_furniture_does_not_stand_in_a_wall():
    place, shape = mut.taken_place(WARD, {"pantry": (0.0, -2.0)})  # The robot itself would fit there.
    assert (place.name, shape.name) == ("pantry", "kitchen_wall_middle")
