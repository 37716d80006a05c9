import math

import numpy as np
import pytest

import mala_drake.ward.displacement as mut
from mala_drake.errors import BadInput
from mala_drake.ward.items import all_items, table_spots, work_spot
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
