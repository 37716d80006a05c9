import casadi
import numpy as np
import pytest
import shapely.affinity
import shapely.ops
from hypothesis import assume, given
from hypothesis import strategies as st

import mala_drake.control.obstacles as mut
from mala_drake.messages import Shape

x, y, slot = casadi.SX.sym("x"), casadi.SX.sym("y"), casadi.SX.sym("slot", mut.OBSTACLE_SIZE)
DISTANCE = mut.signed_distance(x, y, slot)
VALUE = casadi.Function("d", [x, y, slot], [DISTANCE])
GRADIENT = casadi.Function("g", [x, y, slot], [casadi.gradient(DISTANCE, casadi.vertcat(x, y))])

coordinate, size = st.floats(-3, 3), st.floats(0.05, 1.5)
boxes = st.builds(Shape, st.just("box"), coordinate, coordinate, st.floats(-3.2, 3.2), size, size, st.floats(0.0, 0.5))


def packed(shape):
    return mut.pack_obstacles([shape], 1)[0]


def core(shape):
    """The rectangle without its rounding, by shapely."""
    box = shapely.box(-shape.half_length, -shape.half_width, shape.half_length, shape.half_width)
    turned = shapely.affinity.rotate(box, shape.yaw, origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(turned, shape.x, shape.y)


@given(boxes, coordinate, coordinate)
def test_the_distance_is_exact_inside_and_outside(shape, px, py):
    point, rectangle = shapely.Point(px, py), core(shape)
    depth = rectangle.exterior.distance(point)
    expected = (-depth if rectangle.contains(point) else rectangle.distance(point)) - shape.radius
    assert float(VALUE(px, py, packed(shape))) == pytest.approx(expected, abs=1e-8)


@given(boxes, coordinate, coordinate)
def test_outside_the_core_the_gradient_is_the_unit_vector_away(shape, px, py):
    point, rectangle = shapely.Point(px, py), core(shape)
    assume(rectangle.distance(point) > 1e-4)
    near = shapely.ops.nearest_points(rectangle, point)[0]
    away = np.array([px - near.x, py - near.y])
    gradient = GRADIENT(px, py, packed(shape)).full()[:, 0]
    np.testing.assert_allclose(gradient, away / np.hypot(*away), atol=1e-4)


@given(boxes, st.floats(-0.9, 0.9), st.floats(-0.9, 0.9))
def test_inside_the_core_the_gradient_still_points_outward(shape, along, across):
    c, s = np.cos(shape.yaw), np.sin(shape.yaw)
    u, v = along * shape.half_length, across * shape.half_width
    depths = shape.half_length - abs(u), shape.half_width - abs(v)
    assume(abs(depths[0] - depths[1]) > 1e-6)
    px, py = shape.x + c * u - s * v, shape.y + s * u + c * v
    gradient = GRADIENT(px, py, packed(shape)).full()[:, 0]
    before = float(VALUE(px, py, packed(shape)))
    after = float(VALUE(px + 1e-6 * gradient[0], py + 1e-6 * gradient[1], packed(shape)))
    assert np.hypot(*gradient) == pytest.approx(1.0) or min(abs(u), abs(v)) < 1e-9
    assert after >= before


def test_a_disc_is_a_box_without_size_and_its_centre_is_harmless():
    disc = packed(Shape("disc", 1.0, 2.0, radius=0.5))
    assert float(VALUE(4.0, 6.0, disc)) == pytest.approx(4.5)
    assert np.isfinite(GRADIENT(1.0, 2.0, disc).full()).all()


def test_unused_slots_are_out_of_reach():
    slots = mut.pack_obstacles([Shape("disc", 0.0, 0.0, radius=1.0)], 3)
    assert slots.shape == (3, mut.OBSTACLE_SIZE)
    assert [float(VALUE(25.0, 25.0, slot)) > 1000 for slot in slots] == [False, True, True]


def test_the_nearest_shapes_are_kept_with_ties_in_their_order():
    shapes = [Shape(name, at, 0.0, radius=0.1) for name, at in (("far", 9.0), ("a", 2.0), ("b", -2.0), ("near", 1.0))]
    kept = mut.nearest_shapes(shapes, np.array([[0.0, 0.0], [0.0, 1.0]]), 3)
    assert [shape.name for shape in kept] == ["near", "a", "b"]
    assert mut.nearest_shapes(shapes, np.zeros((1, 2)), 4) == tuple(shapes)
