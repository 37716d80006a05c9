import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.ward.shapes as mut
from mala_drake.messages import Shape

coordinates = st.floats(-10, 10)
sizes = st.floats(0.05, 3)
shapes = st.builds(
    Shape,
    name=st.just("piece"),
    x=coordinates,
    y=coordinates,
    yaw=st.floats(-4, 4),
    half_length=sizes,
    half_width=sizes,
    radius=st.one_of(st.just(0.0), st.floats(0.05, 1)),
)
points = st.tuples(coordinates, coordinates)


def core_of(shape):
    """The rectangle without its rounding, made by shapely's own transformations."""
    box = shapely.box(-shape.half_length, -shape.half_width, shape.half_length, shape.half_width)
    turned = shapely.affinity.rotate(box, shape.yaw, origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(turned, shape.x, shape.y)


@given(shape=shapes, point=points)
def test_distances_are_those_of_shapely(shape, point):
    core, at = core_of(shape), shapely.Point(point)
    inside = -core.exterior.distance(at) if core.contains(at) else core.distance(at)
    assert mut.ShapeDistances([shape])(point)[0] == pytest.approx(inside - shape.radius, abs=1e-9)


@given(shape=shapes, point=points, other=points)
def test_distances_change_no_faster_than_one_walks(shape, point, other):
    distances = mut.ShapeDistances([shape])([point, other])[:, 0]
    assert abs(distances[0] - distances[1]) <= math.dist(point, other) + 1e-9


def test_a_disc_has_the_distance_to_its_centre_less_its_radius():
    disc = mut.ShapeDistances([Shape("post", 1.0, 2.0, radius=0.5)])
    assert disc((4.0, 6.0)) == pytest.approx([4.5])
    assert disc((1.0, 2.0)) == pytest.approx([-0.5])


def test_many_points_and_many_shapes_are_measured_at_once():
    pieces = [Shape("a", 0, 0, half_length=1, half_width=1), Shape("b", 5, 0, radius=1)]
    grid = np.zeros((3, 4, 2))
    assert mut.ShapeDistances(pieces)(grid).shape == (3, 4, 2)
    assert mut.ShapeDistances([])(grid).shape == (3, 4, 0)


@given(shape=shapes, margin=st.floats(0.01, 1))
def test_the_outline_cuts_nothing_off_and_adds_little(shape, margin):
    grown = mut.outline(shape, margin=margin)
    exact = core_of(shape).buffer(shape.radius + margin, quad_segs=64)
    assert grown.buffer(1e-9).contains(exact)
    reach = shape.radius + margin
    assert core_of(shape).buffer(1.05 * reach, quad_segs=64).contains(grown)


def test_the_outline_of_a_rectangle_without_margin_is_the_rectangle():
    shape = Shape("table", 1.0, -2.0, 0.3, 0.6, 0.35)
    assert mut.outline(shape).symmetric_difference(core_of(shape)).area == pytest.approx(0.0, abs=1e-12)
