import itertools
import math

import numpy as np
import pytest
import shapely

import mala_drake.ward.items as mut
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.shapes import ShapeDistances, outline

LEDGE_DEPTH = 0.28  # Metres from the face of the furniture to its upper part.


def footprint(pose):
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * np.array(mut.ITEM_SIZE[:2]) / 2
    turn = np.array([[math.cos(pose.yaw), -math.sin(pose.yaw)], [math.sin(pose.yaw), math.cos(pose.yaw)]])
    return shapely.Polygon(corners @ turn.T + (pose.x, pose.y))


def distance_to_standing_point(ward, pose, place):
    standing = ward.place[place]
    return math.dist((standing.x, standing.y), (pose.x, pose.y))


def test_every_medicine_and_supplement_is_kept_at_two_places(ward):
    items = mut.all_items(ward, ("medication",))
    assert len(items) == 12
    assert len({item.name for item in items}) == 12
    for category, kinds in mut.KINDS.items():
        places = [place.name for place in ward.places if place.category == category]
        assert len(places) == 2
        for kind in kinds:
            assert sorted(item.place for item in items if item.kind == kind) == sorted(places)


def test_the_kitchen_keeps_the_ingredients_where_the_case_says(ward):
    items = mut.all_items(ward, ("meal",))
    assert {(item.kind, item.place) for item in items} == {
        *(("bread", "pantry"), ("nuts", "pantry"), ("vegetables", "pantry"), ("chicken", "fridge")),
    }
    assert {item.kind for item in items} == {kind for dish in DISHES.values() for kind in dish.ingredients}
    assert [item.name for item in items if item.kind == "vegetables"] == ["pantry/vegetables", "pantry/vegetables_2"]


def test_all_items_are_those_of_all_tasks(ward):
    assert mut.all_items(ward) == mut.all_items(ward, ("medication",)) + mut.all_items(ward, ("meal",))
    assert mut.all_items(ward, ()) == ()


@pytest.mark.parametrize("task", mut.TASKS)
def test_items_are_named_by_place_and_kind_in_the_order_of_the_map(ward, task):
    items = mut.all_items(ward, (task,))
    assert all(item.name.startswith(f"{item.place}/{item.kind}") for item in items)
    assert len({item.name for item in items}) == len(items)
    order = [place.name for place in ward.places]
    indices = [order.index(item.place) for item in items]
    assert indices == sorted(indices)


def test_items_stand_on_the_ledge_of_the_furniture_in_front(ward):
    for item in mut.all_items(ward):
        piece, standing = ward.furniture_of[item.place], ward.place[item.place]
        assert outline(piece.shape).contains(footprint(item.shelf_pose)), item.name
        face = ShapeDistances([piece.shape])((standing.x, standing.y))[0]
        ahead = (item.shelf_pose.x - standing.x) * math.cos(standing.yaw) + (item.shelf_pose.y - standing.y) * math.sin(
            standing.yaw
        )
        assert ahead + mut.ITEM_SIZE[0] / 2 < face + LEDGE_DEPTH, item.name
        assert item.shelf_pose.z == pytest.approx(mut.LEDGE_HEIGHT + mut.ITEM_HALF_HEIGHT)


def test_the_box_at_the_other_pad_passes_between_the_boxes_on_the_shelf(ward):
    pad_distance, items = 0.14, mut.all_items(ward)
    for picked, other in itertools.permutations(items, 2):
        if picked.place != other.place:
            continue
        for side, turn in itertools.product((1, -1), (-0.3, 0.0, 0.3)):
            yaw = picked.shelf_pose.yaw + turn
            carried = mut.ItemPose(
                picked.shelf_pose.x - side * pad_distance * math.sin(yaw),
                picked.shelf_pose.y + side * pad_distance * math.cos(yaw),
                picked.shelf_pose.z,
                yaw,
            )
            assert footprint(carried).distance(footprint(other.shelf_pose)) > 0.01


def test_a_box_is_put_back_where_its_kind_stands_if_that_is_free(ward):
    for item in mut.all_items(ward, ("medication",)):
        assert mut.return_spots(ward, item.place, item.kind)[0] == item.shelf_pose


def test_the_other_return_spots_are_free_and_on_the_ledge(ward):
    items = mut.all_items(ward, ("medication",))
    for place in {item.place for item in items}:
        spots = mut.return_spots(ward, place, "")
        assert spots
        for spot in spots:
            assert outline(ward.furniture_of[place].shape).contains(footprint(spot))
            for item in items:
                if item.place == place:
                    assert footprint(spot).distance(footprint(item.shelf_pose)) > 0.05


def test_table_spots_hold_pairs_side_by_side(ward):
    for place in ("patient_bed_left", "patient_bed_right"):
        table, spots = ward.furniture_of[place], mut.table_spots(ward, place)
        pairs = []
        for spot in spots:
            assert spot.z == pytest.approx(table.height + mut.ITEM_HALF_HEIGHT)
            for side in (0.07, -0.07):
                x, y = spot.x - side * math.sin(spot.yaw), spot.y + side * math.cos(spot.yaw)
                pairs.append(footprint(mut.ItemPose(x, y, spot.z, spot.yaw)))
        assert all(outline(table.shape).contains(box) for box in pairs)
        assert all(a.distance(b) > 0.05 for a, b in itertools.combinations(pairs, 2))


def test_spots_are_near_enough_for_the_arm(ward):
    places = [place.name for place in ward.places]
    spots = [(item.place, item.shelf_pose) for item in mut.all_items(ward)]
    spots += [(place, spot) for place in places for spot in mut.return_spots(ward, place, "")]
    spots += [(place, spot) for place in places for spot in mut.table_spots(ward, place)]
    assert all(0.4 < distance_to_standing_point(ward, spot, place) < 0.9 for place, spot in spots)


@pytest.mark.parametrize("place", ["pantry", "fridge", "prep_station", "stove", "quality_check"])
def test_the_pair_in_the_gripper_is_worked_on_over_the_ledge(ward, place):
    spot = mut.work_spot(ward, place)
    assert outline(ward.furniture_of[place].shape).contains(footprint(spot))
    assert distance_to_standing_point(ward, spot, place) == pytest.approx(0.7)


@pytest.mark.parametrize("place", ["pharmacy_north", "home", "nowhere", ""])
def test_nothing_is_prepared_outside_the_kitchen(ward, place):
    assert mut.work_spot(ward, place) is None


@pytest.mark.parametrize("place", ["home", "charge_main", "nowhere", "", "pantry"])
def test_nothing_can_be_put_where_there_is_no_ledge_or_table(ward, place):
    assert mut.return_spots(ward, place, "med_insulin") == ()
    assert mut.table_spots(ward, place) == ()
