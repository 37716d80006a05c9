import math

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import mala_drake.robot.line_of_sight as mut
from mala_drake.messages import Shape
from mala_drake.ward.shapes import ShapeDistances, outline
from mala_drake.ward.ward_map import LoadWard

REACH = 6.0


def box(name, x, y, half_length, half_width, yaw=0.0):
    return Shape(name, x, y, yaw, half_length, half_width)


def seen_from(shapes, x, y):
    visible = mut.LineOfSight(shapes, reach=REACH).visible(x, y)
    return {shape.name for shape, is_seen in zip(shapes, visible, strict=True) if is_seen}


def test_what_stands_free_is_seen_up_to_the_reach():
    shapes = [box("near", 3.0, 0.0, 0.5, 0.5), box("far", 7.0, 0.0, 0.5, 0.5), Shape("post", 0.0, -6.3, radius=0.4)]
    assert seen_from(shapes, 0.0, 0.0) == {"near", "post"}


def test_what_stands_behind_a_wall_is_not_seen():
    wall, crate = box("wall", 2.0, 0.0, 0.1, 3.0), box("crate", 4.0, 0.0, 0.3, 0.3)
    assert seen_from([wall, crate], 0.0, 0.0) == {"wall"}
    assert seen_from([wall, crate], 4.0, 2.0) == {"wall", "crate"}


def test_what_sticks_out_behind_something_is_seen():
    assert seen_from([box("crate", 2.0, 0.0, 0.2, 0.5), box("bench", 4.0, 0.0, 0.2, 2.0)], 0.0, 0.0) == {
        "crate",
        "bench",
    }


def test_a_long_wall_is_seen_by_its_nearest_point():
    assert seen_from([box("wall", 0.0, 5.9, 40.0, 0.1)], 0.123, 0.0) == {"wall"}


def test_two_halves_of_a_wall_hide_what_is_behind_their_joint():
    halves = [box("left", 2.0, 1.0, 0.1, 1.0), box("right", 2.0, -1.0, 0.1, 1.0)]
    assert seen_from([*halves, Shape("post", 4.0, 0.0, radius=0.1)], 0.0, 0.0) == {"left", "right"}


def test_shapes_that_touch_do_not_hide_each_other_from_the_side():
    assert seen_from([box("bed", 0.0, 3.0, 1.0, 0.5), box("table", 1.2, 3.0, 0.2, 0.5)], 0.0, 0.0) == {"bed", "table"}


def test_without_shapes_nothing_is_seen():
    assert seen_from([], 0.0, 0.0) == set()


def test_within_a_shape_only_that_shape_is_seen():
    assert seen_from([box("hall", 0.0, 0.0, 2.0, 2.0), Shape("post", 4.0, 0.0, radius=0.1)], 0.5, 0.5) == {"hall"}


@st.composite
def rooms(draw):
    """Shapes that do not touch one another or the eye at the origin, as in a ward."""
    shapes = []
    for i in range(draw(st.integers(1, 7))):
        shape = Shape(
            f"s{i}",
            draw(st.floats(-6, 6)),
            draw(st.floats(-6, 6)),
            draw(st.floats(-3, 3)),
            draw(st.floats(0.05, 1.5)),
            draw(st.floats(0.05, 1.5)),
            draw(st.sampled_from([0.0, 0.3])),
        )
        grown = outline(shape, margin=0.05)
        if not grown.contains(shapely.Point(0, 0)) and not any(grown.intersects(outline(s)) for s in shapes):
            shapes.append(shape)
    return shapes


def share_in_sight(shape, shapes, *, shrink):
    """How much of a shape's outline shapely sees from the origin past the others, made smaller by `shrink` metres."""
    ring = outline(shape).exterior
    points = [ring.interpolate(s) for s in np.linspace(0.0, ring.length, 200)]
    near = [point for point in points if point.distance(shapely.Point(0, 0)) < REACH + shrink]
    others = shapely.union_all([outline(other).buffer(-shrink) for other in shapes if other is not shape])
    return sum(not shapely.LineString([(0, 0), point]).intersects(others) for point in near) / len(points)


@settings(max_examples=60, deadline=None)
@given(shapes=rooms())
def test_whatever_shapely_sees_well_is_seen_and_whatever_it_does_not_see_is_not(shapes):
    visible = mut.LineOfSight(shapes, reach=REACH).visible(0.0, 0.0)
    for shape, is_seen in zip(shapes, visible, strict=True):
        if share_in_sight(shape, shapes, shrink=1e-6) > 0.25:
            assert is_seen, shape
        if share_in_sight(shape, shapes, shrink=0.1) == 0.0:
            assert not is_seen, shape


def test_in_the_ward_only_near_things_are_seen_and_the_nearest_always_is():
    ward = LoadWard()
    sight, distances = mut.LineOfSight(ward.shapes, reach=REACH), ShapeDistances(ward.shapes)
    for place in ward.places:
        visible, distance = sight.visible(place.x, place.y), distances((place.x, place.y))
        assert (distance[visible] <= REACH).all()
        assert visible[distance.argmin()] or distance.min() > REACH


def test_the_patients_room_is_not_seen_into_from_the_corridor():
    ward = LoadWard()
    visible = mut.LineOfSight(ward.shapes, reach=REACH).visible(16.9, 8.0)
    names = {shape.name for shape, is_seen in zip(ward.shapes, visible, strict=True) if is_seen}
    bed = next(shape for shape in ward.shapes if shape.name == "bed")
    assert math.dist((16.9, 8.0), (bed.x, bed.y)) < REACH
    assert "room_wall_west_lower" in names
    assert "bed" not in names
