"""Medians with a band over runs, drawn by episode, and words at their ends."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import Locator, MaxNLocator
from numpy.typing import NDArray

from mala_drake.reporting.quantiles import spread

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LINE_HEIGHT = 1.25  # Of a label, in its own type size.


def episode_locator() -> Locator:
    """Few ticks at whole, round numbers of episodes."""
    return MaxNLocator(5, integer=True, steps=[1, 2, 5, 10], min_n_ticks=1)


def aligned(series: Iterable[Sequence[float]]) -> NDArray[np.float64]:
    """Series of different lengths as rows of one array, shape (n, longest), with NaN where one has ended."""
    rows = [np.asarray(each, dtype=float) for each in series]
    longest = max((row.size for row in rows), default=0)
    return np.array([np.pad(row, (0, longest - row.size), constant_values=np.nan) for row in rows])


def draw_band(axes: Axes, x: Sequence[float], values: NDArray[np.float64], color: str, **line: object) -> None:
    """Draws the median of the rows of `values` over `x`, and the band between their quartiles."""
    spreads = [spread(column) for column in values.T]
    axes.fill_between(
        x, [each.lower for each in spreads], [each.upper for each in spreads], color=color, alpha=0.2, linewidth=0
    )
    # A point alone makes no line.
    marker = "o" if len(x) == 1 else ""
    axes.plot(x, [each.median for each in spreads], color=color, marker=marker, markersize=3, **line)


def label_ends(axes: Axes, x: float, labels: Sequence[tuple[float, str, str]], *, size: float = 7.0) -> None:
    """Writes labels to the right of (x, y), moved up and down so that none covers another.

    Args:
        axes: with its limits set.
        x: of the ends, in data.
        labels: y in data, text and color of each.
        size: of the type, points.
    """
    figure = axes.get_figure()
    if figure is None or not labels:
        return
    ordered = sorted(labels)
    pixels = [float(axes.transData.transform((x, y))[1]) for y, _, _ in ordered]
    low, high = axes.transAxes.transform([(0, 0), (1, 1)])[:, 1]
    gap = _LINE_HEIGHT * size * figure.dpi / 72.0
    placed = spaced(pixels, gap, float(low) + gap / 2, float(high) - gap / 2)
    for (y, text, color), before, after in zip(ordered, pixels, placed, strict=True):
        shift = (5.0, (after - before) * 72.0 / figure.dpi)
        axes.annotate(
            text,
            (x, y),
            shift,
            textcoords="offset points",
            color=color,
            va="center",
            fontsize=size,
            annotation_clip=False,
        )


def spaced_by_widths(positions: Sequence[float], widths: Sequence[float]) -> list[float]:
    """Middles of things of some widths, in this order, as near to `positions` as they can be without overlapping.

    It is the least squares solution: the distances are taken off, which leaves an isotonic regression, solved by
    pooling adjacent violators.
    """
    offsets, place = [], 0.0
    for i, width in enumerate(widths):
        place += (width + widths[i - 1]) / 2 if i else 0.0
        offsets.append(place)
    pools: list[tuple[float, int]] = []  # Mean and count.
    for position, offset in zip(positions, offsets, strict=True):
        mean, count = position - offset, 1
        while pools and pools[-1][0] > mean:
            before, number = pools.pop()
            mean, count = (mean * count + before * number) / (count + number), count + number
        pools.append((mean, count))
    shifts = [mean for mean, count in pools for _ in range(count)]
    return [shift + offset for shift, offset in zip(shifts, offsets, strict=True)]


def spaced(positions: Sequence[float], gap: float, low: float, high: float) -> list[float]:
    """Positions in rising order moved as little as needed to be `gap` apart, within [low, high] if there is room."""
    placed = spaced_by_widths(positions, [gap] * len(positions))
    highest = high - gap * (len(placed) - 1)
    return [max(min(place, highest + i * gap), low + i * gap) for i, place in enumerate(placed)]
