"""Room for labels: no two cover each other as long as there is room, and they stay near and in bounds."""

from __future__ import annotations

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.reporting.figures.label_places import Label, place_labels

BOUNDS = (0.0, 0.0, 100.0, 100.0)
cells = st.lists(st.tuples(st.integers(1, 4), st.integers(1, 8)), min_size=1, max_size=12, unique=True)


def overlap(a, b):
    return max(min(a[2], b[2]) - max(a[0], b[0]), 0.0) * max(min(a[3], b[3]) - max(a[1], b[1]), 0.0)


@given(points=cells)
def test_labels_do_not_cover_each_other_or_any_point(points):
    labels = [Label(20.0 * x, 11.0 * y, 14.0, 4.0) for x, y in points]
    boxes = place_labels(labels, bounds=BOUNDS, gap=1.0)
    assert all(overlap(a, b) < 1e-9 for a, b in combinations(boxes, 2))
    for left, bottom, right, top in boxes:
        assert not any(left < label.x < right and bottom < label.y < top for label in labels)
        assert left >= 0
        assert bottom >= 0
        assert right <= 100
        assert top <= 100


@pytest.mark.parametrize(
    ("x", "y"), [(1.0, 50.0), (99.0, 50.0), (50.0, 1.0), (50.0, 99.0), (1.0, 1.0), (99.0, 99.0), (50.0, 50.0)]
)
def test_a_label_alone_is_beside_its_point_and_in_bounds(x, y):
    ((left, bottom, right, top),) = place_labels([Label(x, y, 14.0, 4.0)], bounds=BOUNDS, gap=0.9)
    assert left >= 0
    assert bottom >= 0
    assert right <= 100
    assert top <= 100
    assert max(left - x, x - right, bottom - y, y - top) == pytest.approx(0.9)


def test_what_should_be_seen_is_not_covered():
    wall = (50.0, 0.0, 80.0, 100.0)
    (box,) = place_labels([Label(49.0, 50.0, 14.0, 4.0)], obstacles=[wall], bounds=BOUNDS)
    assert overlap(box, wall) == 0.0


def test_labels_are_given_in_the_order_of_their_points():
    labels = [Label(80.0, 50.0, 5.0, 2.0), Label(10.0, 50.0, 5.0, 2.0)]
    first, second = place_labels(labels)
    assert first[0] > 50.0 > second[0]
