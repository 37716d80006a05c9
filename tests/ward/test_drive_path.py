import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import mala_drake.ward.drive_path as mut
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.routes import Route
from mala_drake.ward.ward_map import Ward, Zone

BUSY = Zone("busy", 0.5, ((4.0, -1.0), (8.0, -1.0), (8.0, 1.0), (4.0, 1.0)))


def congestion(*zones):
    return Congestion(Ward("test", 40.0, 0.2, 2.0, (), (), zones, 0.02))


EMPTY = congestion()
FREE_SPEED = 1.5 / 1.02


def path_along(points, *zones):
    return mut.make_drive_path(Route(np.array(points, dtype=float)), congestion(*zones) if zones else EMPTY)


coordinate = st.floats(-15, 15)


@st.composite
def routes(draw):
    """Routes like those of the planner: legs of half a metre and more."""
    points = [np.array([draw(coordinate), draw(coordinate)])]
    direction = 0.0
    for _ in range(draw(st.integers(1, 5))):
        direction += draw(st.floats(-2.5, 2.5))
        points.append(points[-1] + draw(st.floats(0.5, 6)) * np.array([math.cos(direction), math.sin(direction)]))
    return np.array(points)


def test_a_straight_path_is_driven_on_a_trapezoid():
    path = path_along([[0, 0], [20, 0]])
    up, down = FREE_SPEED**2 / (2 * mut.ACCELERATION), FREE_SPEED**2 / (2 * mut.DECELERATION)
    seconds = FREE_SPEED / mut.ACCELERATION + (20 - up - down) / FREE_SPEED + FREE_SPEED / mut.DECELERATION
    assert path.length == pytest.approx(20.0)
    assert path.speeds.max() == pytest.approx(FREE_SPEED)
    assert path.duration == pytest.approx(seconds, rel=0.01)


def test_a_short_path_never_gets_up_to_speed():
    path = path_along([[0, 0], [1, 0]])
    peak = math.sqrt(2 * mut.ACCELERATION * mut.DECELERATION / (mut.ACCELERATION + mut.DECELERATION))
    assert path.speeds.max() == pytest.approx(peak, rel=0.03)


def test_a_busy_zone_is_crossed_at_its_limit_and_braked_for_in_time():
    path = path_along([[0, 0], [12, 0]], BUSY)
    inside = (path.points[:, 0] > 4.0) & (path.points[:, 0] < 8.0)
    assert path.speeds[inside].max() <= 1.0 + 1e-9
    assert path.speeds.max() > 1.2


@settings(max_examples=50, deadline=None)
@given(points=routes())
def test_speeds_stay_within_all_limits(points):
    path = mut.make_drive_path(Route(points), EMPTY)
    squares = path.speeds**2
    gaps = np.diff(path.lengths)
    assert (np.diff(squares) <= 2 * mut.ACCELERATION * gaps + 1e-9).all()
    assert (-np.diff(squares) <= 2 * mut.DECELERATION * gaps + 1e-9).all()
    assert path.speeds[0] == path.speeds[-1] == 0.0
    assert (path.speeds[1:-1] > 0).all()
    assert (path.speeds <= path.ceilings + 1e-12).all()
    assert path.ceilings.max() <= FREE_SPEED + 1e-9


@settings(max_examples=50, deadline=None)
@given(points=routes())
def test_corners_are_cut_by_centimetres_only(points):
    path = mut.make_drive_path(Route(points), EMPTY)
    assert path.points[0] == pytest.approx(points[0])
    assert path.points[-1] == pytest.approx(points[-1])
    route, driven = shapely.LineString(points), shapely.LineString(path.points)
    assert driven.hausdorff_distance(route) <= 0.06 + mut.SPACING
    assert path.length <= route.length + 1e-6


@settings(max_examples=50, deadline=None)
@given(points=routes())
def test_times_and_headings_belong_to_the_samples(points):
    path = mut.make_drive_path(Route(points), EMPTY)
    steps = np.diff(path.points, axis=0)
    lengths = np.hypot(*steps.T)
    assert np.diff(path.lengths) == pytest.approx(lengths)
    assert lengths.max() <= mut.SPACING + 1e-9
    assert (np.diff(path.times) > 0).all()
    mean_speeds = lengths / np.diff(path.times)
    assert (mean_speeds <= np.maximum(path.speeds[1:], path.speeds[:-1]) + 1e-9).all()
    assert np.cos(path.headings[:-1]) == pytest.approx(steps[:, 0] / lengths, abs=1e-6)
    assert (np.abs(np.diff(path.headings)) <= math.pi).all()


def test_curves_are_driven_slower_than_straights():
    path = path_along([[0, 0], [10, 0], [10, 10]])
    corner = np.hypot(*(path.points - [10, 0]).T).argmin()
    assert path.speeds[corner] < 0.8 * path.speeds.max()
    assert path.speeds[corner] >= 0.15


def test_a_lower_cruise_speed_is_kept():
    route = Route(np.array([[0.0, 0.0], [10.0, 0.0]]))
    assert mut.make_drive_path(route, EMPTY, cruise_speed=0.7).speeds.max() == pytest.approx(0.7)


def test_repeated_corners_do_no_harm():
    path = path_along([[0, 0], [5, 0], [5, 0], [5, 5]])
    assert np.isfinite(path.points).all()
    assert np.isfinite(path.times).all()


def test_the_arrays_cannot_be_written_to():
    path = path_along([[0, 0], [5, 0]])
    for array in (path.lengths, path.points, path.headings, path.ceilings, path.speeds, path.times):
        assert not array.flags.writeable
