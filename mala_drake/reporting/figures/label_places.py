"""Finds room for labels beside points, so that none covers another or anything that should be seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

Box = tuple[float, float, float, float]
"""Left, bottom, right and top."""

_SLIDES = (0.0, -0.25, 0.25, -0.5, 0.5)  # Of a label above or below its point to the side, in its own widths.
_GAPS = (1.0, 2.2, 3.6, 5.5)  # Of a label from its point, in gaps.
_RANK = 0.03  # Cost of each candidate that comes before.


@dataclass(frozen=True, slots=True)
class Label:
    """Something to be written beside a point: the point and the size of the text, in one unit."""

    x: float
    y: float
    width: float
    height: float


def place_labels(
    labels: Sequence[Label],
    *,
    obstacles: Sequence[Box] = (),
    bounds: Box | None = None,
    gap: float = 1.0,
) -> list[Box]:
    """A box for each label, chosen one after another, the ones with the least room first.

    Args:
        labels: in any order.
        obstacles: boxes that should not be covered.
        bounds: within which labels have to be, if possible.
        gap: between a point and the nearest label that is tried.
    """
    candidates = [_candidates(label, gap) for label in labels]
    fixed = [
        [_cost(box, obstacles, bounds) + _mistakable(box, labels, i, gap) for box in boxes]
        for i, boxes in enumerate(candidates)
    ]
    order = sorted(range(len(labels)), key=lambda i: (-min(fixed[i]), labels[i].x, labels[i].y))
    chosen: dict[int, Box] = {}
    for i in order:
        taken = list(chosen.values())
        costs = [
            cost + 10.0 * sum(_overlap(box, other) for other in taken) / _area(box) + _RANK * rank
            for rank, (box, cost) in enumerate(zip(candidates[i], fixed[i], strict=True))
        ]
        chosen[i] = candidates[i][int(np.argmin(costs))]
    return [chosen[i] for i in range(len(labels))]


def _candidates(label: Label, gap: float) -> list[Box]:
    """Boxes round the point, near ones first: to the right, to the left, above and below."""
    middles = []
    for distance in (gap * each for each in _GAPS):
        beside, above = label.width / 2 + distance, label.height / 2 + distance
        middles += [(beside, 0.0), (-beside, 0.0)]
        middles += [(slide * label.width, up) for slide in _SLIDES for up in (above, -above)]
    x, y, half_width, half_height = label.x, label.y, label.width / 2, label.height / 2
    return [(x + a - half_width, y + b - half_height, x + a + half_width, y + b + half_height) for a, b in middles]


def _cost(box: Box, obstacles: Sequence[Box], bounds: Box | None) -> float:
    """What is covered, in areas of the label, and what is out of bounds."""
    covered = sum(_overlap(box, other) for other in obstacles) / _area(box)
    outside = 0.0 if bounds is None else 20.0 * (1.0 - _overlap(box, bounds) / _area(box))
    return covered + outside


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
