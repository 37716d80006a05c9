"""The ward from above: its floor with what stands there, and its places with their names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely

from mala_drake.reporting.figures.label_places import Box, Label, place_labels
from mala_drake.reporting.figures.style import BUSY, FLOOR, FURNITURE, INK, MUTED, PAPER, PLACE_COLORS, WALL
from mala_drake.reporting.wording import words
from mala_drake.ward.shapes import outline
from mala_drake.ward.ward_map import Furniture, Place, Ward

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.text import Text

LABEL_SIZE = 6.0
"""Of names on a plan, points."""

_FAR = 1.8  # Metres from a place beyond which its name is joined to it by a line.


def draw_ward(axes: Axes, ward: Ward, view: Box, *, zones: bool = True) -> None:
    """The floor, with its zones if wanted, and everything solid."""
    left, bottom, right, top = view
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_aspect("equal")
    axes.set_facecolor(FLOOR)
    axes.grid(visible=False)
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)
    for level, part in _zone_parts(ward) if zones else ():
        axes.fill(*np.array(part.exterior.coords).T, color=BUSY, alpha=zone_shade(level), linewidth=0, zorder=1)
    for piece in (*ward.furniture, *ward.walls):
        corners = np.array(outline(piece.shape).exterior.coords)
        axes.fill(*corners.T, color=WALL if _is_wall(piece) else FURNITURE, linewidth=0, zorder=2)


def _is_wall(piece: Furniture) -> bool:
    return piece.model in ("wall", "partition", "privacy_screen")


def _zone_parts(ward: Ward) -> Iterator[tuple[float, shapely.Polygon]]:
    """The zones without what belongs to a zone of a higher level, which is the one that counts."""
    higher = shapely.Polygon()
    for zone in sorted(ward.zones, key=lambda each: (-each.level, each.name)):
        polygon = shapely.Polygon(zone.polygon)
        for part in shapely.get_parts(polygon.difference(higher)):
            if isinstance(part, shapely.Polygon):
                yield from ((zone.level, piece) for piece in _without_holes(part))
        higher = higher.union(polygon)


def _without_holes(polygon: shapely.Polygon) -> Iterator[shapely.Polygon]:
    """The polygon, cut through its holes, for a polygon that is filled has none."""
    if not polygon.interiors:
        yield polygon
        return
    left, bottom, right, top = polygon.bounds
    x = shapely.Polygon(polygon.interiors[0]).centroid.x
    for half in (shapely.box(left, bottom, x, top), shapely.box(x, bottom, right, top)):
        for part in shapely.get_parts(polygon.intersection(half)):
            if isinstance(part, shapely.Polygon):
                yield from _without_holes(part)


def zone_shade(level: float) -> float:
    """How much of the color of congestion there is on the floor of a zone."""
    return 0.06 + 0.4 * level


def name_zones(axes: Axes, ward: Ward) -> list[Box]:
    """Writes the level of each zone into the lower right corner of what is seen of it; returns where."""
    boxes = []
    for zone in ward.zones:
        x, y = max(x for x, _ in zone.polygon), min(y for _, y in zone.polygon)
        x, y = min(x, axes.get_xlim()[1]) - 0.3, max(y, axes.get_ylim()[0]) + 0.3
        if not shapely.Polygon(zone.polygon).contains(shapely.Point(x, y)):
            continue
        text = axes.text(
            x,
            y,
            f"{zone.level:g}",
            ha="right",
            va="bottom",
            fontsize=LABEL_SIZE,
            color=BUSY,
            zorder=3,
            in_layout=False,
        )
        boxes.append(extent(axes, text))
    return boxes


def extent(axes: Axes, text: Text) -> Box:
    """The box of a text that has been drawn, in data."""
    (left, bottom), (right, top) = axes.transData.inverted().transform(text.get_window_extent())
    return float(left), float(bottom), float(right), float(top)


def mark_places(axes: Axes, places: Sequence[Place]) -> None:
    """A dot for each place, colored by its kind."""
    for place in places:
        color = PLACE_COLORS[place.category]
        axes.plot(
            place.x,
            place.y,
            "o",
            markersize=4.2,
            markerfacecolor=color,
            markeredgecolor=PAPER,
            markeredgewidth=0.7,
            zorder=6,
        )


def name_places(axes: Axes, ward: Ward, places: Sequence[Place], taken: Sequence[Box]) -> None:
    """Writes the names beside the places, clear of one another and, where there is room, of furniture."""
    texts = [
        axes.text(p.x, p.y, words(p.name), fontsize=LABEL_SIZE, color=INK, zorder=7, in_layout=False) for p in places
    ]
    boxes = [extent(axes, text) for text in texts]
    labels = [
        Label(p.x, p.y, right - left, top - bottom) for p, (left, bottom, right, top) in zip(places, boxes, strict=True)
    ]
    obstacles: list[Box] = [*taken, *(outline(piece.shape).bounds for piece in ward.furniture)]
    obstacles += [(place.x - 0.6, place.y - 0.6, place.x + 0.6, place.y + 0.6) for place in places]
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    found = place_labels(labels, obstacles=obstacles, bounds=(left, bottom, right, top), gap=0.8)
    for text, place, (x0, y0, x1, y1) in zip(texts, places, found, strict=True):
        text.set(x=(x0 + x1) / 2, y=(y0 + y1) / 2, ha="center", va="center_baseline")
        nearest = (min(max(place.x, x0), x1), min(max(place.y, y0), y1))
        if np.hypot(nearest[0] - place.x, nearest[1] - place.y) > _FAR:
            axes.plot([place.x, nearest[0]], [place.y, nearest[1]], color=MUTED, linewidth=0.5, zorder=5)
