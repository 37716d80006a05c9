"""Finds room for labels beside points, so that none covers another or anything that should be seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Box = tuple[float, float, float, float]
"""Left, bottom, right and top."""

_SLIDES = (0.0, -0.25, 0.25, -0.5, 0.5)  # Of a label above or below its point to the side, in its own widths.
_GAPS = (1.0, 2.2, 3.6, 5.5)  # Of a label from its point, in gaps.
_RANK = 0.03  # Cost of each candidate that comes before.
_POINT = 0.1  # Cost of covering a point.
_ROUNDS = 3


@dataclass(frozen=True, slots=True)
class Label:
    """Something to be written beside a point: the point and the size of the text, in one unit."""

    x: float
    y: float
    width: float
    height: float


def place_labels(
    labels: Sequence[Label], *, obstacles: Sequence[Box] = (), bounds: Box | None = None, gap: float = 1.0
) -> list[Box]:
    """A box for each label beside its point.

    Args:
        labels: in any order.
        obstacles: boxes that should not be covered.
        bounds: within which labels have to be, if possible.
        gap: between a point and the nearest label that is tried.
    """
    candidates = [
        [(box, _RANK * rank + _mistakable(box, labels, i, gap)) for rank, box in enumerate(_candidates(label, gap))]
        for i, label in enumerate(labels)
    ]
    return choose_boxes(candidates, obstacles=obstacles, bounds=bounds)


def choose_boxes(
    candidates: Sequence[Sequence[tuple[Box, float]]],
    *,
    obstacles: Sequence[Box] = (),
    points: NDArray[np.float64] | None = None,
    bounds: Box | None = None,
) -> list[Box]:
    """One of its candidates for each of several labels.

    They are chosen one after another, the ones with the least room first, and again once the others are there.

    Args:
        candidates: boxes of a label, each with a cost of its own; covering its whole area costs 1.
        obstacles: boxes that should not be covered.
        points: single points that should not be covered, shape (n, 2); each costs `_POINT`.
        bounds: within which labels have to be, if possible.
    """
    points = np.empty((0, 2)) if points is None else points
    costs = [[cost + _cost(box, obstacles, points, bounds) for box, cost in each] for each in candidates]
    order = sorted(range(len(candidates)), key=lambda i: (-min(costs[i]), i))
    chosen: dict[int, Box] = {}
    for i in order * _ROUNDS:
        taken = [box for other, box in chosen.items() if other != i]
        total = [
            cost + 10.0 * sum(_overlap(box, other) for other in taken) / _area(box)
            for (box, _), cost in zip(candidates[i], costs[i], strict=True)
        ]
        chosen[i] = candidates[i][int(np.argmin(total))][0]
    return [chosen[i] for i in range(len(candidates))]


def _candidates(label: Label, gap: float) -> list[Box]:
    """Boxes round the point, near ones first: to the right, to the left, above and below."""
    middles = []
    for distance in (gap * each for each in _GAPS):
        beside, above = label.width / 2 + distance, label.height / 2 + distance
        middles += [(beside, 0.0), (-beside, 0.0)]
        middles += [(slide * label.width, up) for slide in _SLIDES for up in (above, -above)]
    x, y, half_width, half_height = label.x, label.y, label.width / 2, label.height / 2
    return [(x + a - half_width, y + b - half_height, x + a + half_width, y + b + half_height) for a, b in middles]


def _cost(box: Box, obstacles: Sequence[Box], points: NDArray[np.float64], bounds: Box | None) -> float:
    """What is covered, in areas of the label, and what is out of bounds."""
    left, bottom, right, top = box
    covered = sum(_overlap(box, other) for other in obstacles) / _area(box)
    outside = 0.0 if bounds is None else 20.0 * (1.0 - _overlap(box, bounds) / _area(box))
    inside = (points[:, 0] > left) & (points[:, 0] < right) & (points[:, 1] > bottom) & (points[:, 1] < top)
    return covered + outside + _POINT * float(np.count_nonzero(inside))


def _mistakable(box: Box, labels: Sequence[Label], own: int, gap: float) -> float:
    """How many other points are so near that the label might be taken for theirs."""
    left, bottom, right, top = box
    reach = 2.0 * gap
    near = (
        i != own and left - reach < other.x < right + reach and bottom - reach < other.y < top + reach
        for i, other in enumerate(labels)
    )
    return float(sum(near))


def _overlap(a: Box, b: Box) -> float:
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    return max(width, 0.0) * max(height, 0.0)


def _area(box: Box) -> float:
    return max((box[2] - box[0]) * (box[3] - box[1]), 1e-12)
