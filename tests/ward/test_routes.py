import math

import numpy as np
import pytest
import scipy.sparse
from scipy.sparse.csgraph import dijkstra

import mala_drake.ward.routes as mut
from mala_drake.messages import Shape
from mala_drake.ward.congestion import sample
from mala_drake.ward.shapes import ShapeDistances

WIDE = mut.BODY_RADIUS + mut.ROUTE_CLEARANCE
OUTLINE = 1.02  # By how much rounded corners of an outline may stand out beyond the margin.
DETOUR = 1.0824  # The longest that a way along the eight directions of a grid is, compared with the straight one.


def box_room():
    """A wall across a room, with gaps at both ends."""
    return (
        Shape("north", 0.0, 6.0, half_length=8.0, half_width=0.1),
        Shape("south", 0.0, -6.0, half_length=8.0, half_width=0.1),
        Shape("east", 8.0, 0.0, half_length=0.1, half_width=6.0),
        Shape("west", -8.0, 0.0, half_length=0.1, half_width=6.0),
        Shape("middle", 0.0, -1.0, half_length=0.1, half_width=3.0),
    )


@pytest.fixture(scope="module")
def planner(ward):
    return mut.RoutePlanner(ward.shapes)


@pytest.fixture(scope="module")
def room():
    return mut.RoutePlanner(box_room())


def grid_distances(shapes, margin, start, spacing=0.25, half_extent=25.0):
    """Lengths of the shortest ways from `start` over a grid of points that keep `margin`, and a look-up of points."""
    axis = np.arange(-half_extent, half_extent + spacing / 2, spacing)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    free = ShapeDistances(shapes)(np.stack((x, y), axis=-1)).min(axis=-1) >= margin
    index = np.arange(free.size).reshape(free.shape)
    rows, columns, lengths = [], [], []
    for di, dj in ((1, 0), (0, 1), (1, 1), (1, -1)):
        a = (slice(0, len(axis) - di), slice(max(0, -dj), len(axis) - max(0, dj)))
        b = (slice(di, len(axis)), slice(max(0, dj), len(axis) + min(0, dj)))
        both = free[a] & free[b]
        rows.append(index[a][both])
        columns.append(index[b][both])
        lengths.append(np.full(both.sum(), spacing * math.hypot(di, dj)))
    edges = (np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns)))
    graph = scipy.sparse.csr_matrix(edges, shape=(free.size, free.size))

    def node(point):
        return int(index[tuple(np.rint((np.array(point) + half_extent) / spacing).astype(int))])

    distances = dijkstra(graph, directed=False, indices=node(start))
    return lambda point: distances[node(point)]


def test_a_free_way_is_straight(room):
    route = room.route((2.0, -4.0), (5.0, 4.0))
    assert route.points == pytest.approx(np.array([[2.0, -4.0], [5.0, 4.0]]))
    assert route.length == pytest.approx(math.hypot(3.0, 8.0))


def test_the_way_round_a_wall_end_has_the_length_of_a_tight_string(room):
    # The gap above the wall's end at (0, 2) is taken; the string runs round the disc of the margin about both corners.
    route = room.route((-4.0, 2.0), (4.0, 2.0))
    tangent = math.sqrt(3.9**2 - WIDE**2)  # From the start to the circle round the corner (-0.1, 2).
    arc = WIDE * (math.pi / 2 - math.acos(WIDE / 3.9))
    assert route.length == pytest.approx(2 * tangent + 2 * arc + 0.2, rel=0.005)


def test_routes_keep_their_clearance(ward, planner):
    distances = ShapeDistances(ward.shapes)
    route = planner.route((0.0, 0.0), (-3.0, 15.0))
    assert distances(sample(route.points)[0]).min() >= WIDE - 1e-6


def test_routes_are_as_short_as_those_over_a_fine_grid(ward, planner):
    """A grid with more room gives an upper bound; one with less room, less its detours, a lower bound."""
    spacing, start = 0.25, (0.0, 0.0)
    longer = grid_distances(ward.shapes, WIDE * OUTLINE + spacing, start, spacing)
    shorter = grid_distances(ward.shapes, WIDE - spacing, start, spacing)
    for goal in ((-3.0, 15.0), (5.0, 17.0), (6.0, -16.0), (13.0, 10.0), (14.0, -12.0), (16.0, -17.0), (20.0, 12.0)):
        length = planner.route(start, goal).length
        assert length <= longer(goal) + 1e-6
        assert length >= shorter(goal) / DETOUR - 2 * spacing


def test_the_way_back_is_as_long(planner):
    there, back = planner.route((0.0, 0.0), (20.0, 12.0)), planner.route((20.0, 12.0), (0.0, 0.0))
    assert there.length == pytest.approx(back.length)


def test_nothing_leads_to_a_place_inside_something(room):
    assert room.route((2.0, 2.0), (0.0, -1.0)) is None
    assert room.route((2.0, 2.0), (20.0, 0.0)) is None


def test_nothing_leads_through_a_closed_door(room):
    door = Shape("door", 0.0, 4.0, half_length=0.1, half_width=2.5)
    lower = Shape("lower", 0.0, -5.0, half_length=0.1, half_width=1.5)
    assert room.route((-4.0, 2.0), (4.0, 2.0), unmapped=[door]) is not None
    assert room.route((-4.0, 2.0), (4.0, 2.0), unmapped=[door, lower]) is None


def test_what_only_the_sensor_has_seen_is_gone_round(room):
    crate = Shape("crate", 0.0, 2.9, half_length=0.3, half_width=0.4)
    without, around = room.route((-4.0, 2.0), (4.0, 2.0)), room.route((-4.0, 2.0), (4.0, 2.0), unmapped=[crate])
    assert around.length > without.length
    assert ShapeDistances([*box_room(), crate])(sample(around.points)[0]).min() >= WIDE - 1e-6
    assert room.route((-4.0, 2.0), (4.0, 2.0)).length == without.length


def test_a_narrow_door_is_passed_at_the_tight_clearance(room):
    narrow = Shape("crate", 0.0, 4.4, half_length=0.1, half_width=1.5)  # Leaves 0.9 m above the wall.
    lower = Shape("lower", 0.0, -5.0, half_length=0.1, half_width=1.5)
    route = room.route((-4.0, 2.0), (4.0, 2.0), unmapped=[narrow, lower])
    clearance = ShapeDistances([*box_room(), narrow, lower])(sample(route.points)[0]).min()
    assert mut.BODY_RADIUS + 0.1 - 1e-6 <= clearance < WIDE


def test_a_start_too_close_to_a_wall_is_left_by_the_shortest_way(room):
    route = room.route((0.3, -1.0), (4.0, -1.0))
    assert route.points[0] == pytest.approx([0.3, -1.0])
    assert route.points[1] == pytest.approx([0.1 + WIDE, -1.0], abs=0.02)


def test_a_start_between_a_thin_wall_and_something_is_not_left_through_the_wall():
    wall = Shape("wall", 0.0, -1.0, half_length=0.05, half_width=3.0)
    trolley = Shape("trolley", 1.17, -1.0, half_length=0.3, half_width=1.5)  # Leaves 0.82 m.
    shapes = (*box_room()[:-1], wall)
    route = mut.RoutePlanner(shapes).route((0.34, -1.0), (4.0, -1.0), unmapped=[trolley])
    assert ShapeDistances([*shapes, trolley])(sample(route.points)[0]).min() >= mut.BODY_RADIUS


def test_a_start_that_is_taken_to_be_inside_something_gets_out_of_it(room):
    route = room.route((0.05, -1.0), (4.0, -1.0))
    assert route.points[1] == pytest.approx([0.1 + WIDE, -1.0], abs=0.02)


@pytest.mark.parametrize("depth", [0.0, 1e-9, 1e-6, 1e-3])
def test_a_start_on_the_edge_of_the_free_space_gets_away(room, depth):
    edge = float(room.route((0.3, -1.0), (4.0, -1.0)).points[1][0]) - 2e-3
    assert room.route((edge - depth, -1.0), (4.0, -1.0)).length == pytest.approx(4.0 - edge, abs=0.01)


def test_the_order_in_which_obstacles_were_seen_does_not_matter(room):
    crates = [Shape(f"crate{i}", 1.0 + i, 3.0, half_length=0.2, half_width=0.2) for i in range(3)]
    forward = room.route((-4.0, 2.0), (5.0, 4.0), unmapped=crates)
    backward = room.route((-4.0, 2.0), (5.0, 4.0), unmapped=crates[::-1])
    assert np.array_equal(forward.points, backward.points)


def test_routes_cannot_be_written_to(room):
    with pytest.raises(ValueError, match="read-only"):
        room.route((2.0, -4.0), (5.0, 4.0)).points[0, 0] = 1.0


def test_segments_are_free_or_not(room):
    assert room.segment_is_free((2.0, -4.0), (5.0, 4.0))
    assert not room.segment_is_free((-2.0, 0.0), (2.0, 0.0))
    assert not room.segment_is_free((0.2, 0.0), (2.0, 0.0))
