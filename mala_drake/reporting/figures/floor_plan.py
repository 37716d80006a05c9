"""The ward from above, with the ways the robot took for each patient (paper, Fig. "floor_plan")."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely

from mala_drake.reporting.executed_legs import ExecutedLegs, executed_legs
from mala_drake.reporting.figures.label_places import Box, Label, place_labels
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import (
    BUSY,
    FLOOR,
    FURNITURE,
    INK,
    MUTED,
    PAPER,
    PLACE_COLORS,
    WALL,
    WIDTH,
    new_figure,
    profile_color,
)
from mala_drake.reporting.results import Results
from mala_drake.reporting.wording import title_of, words
from mala_drake.ward.legs import leg_planner
from mala_drake.ward.shapes import outline
from mala_drake.ward.ward_map import Furniture, Place, Ward

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

_MARGIN = 3.0  # Metres shown round the legs.
_LABEL_SIZE = 6.0
_FAR = 1.8  # Metres from a place beyond which its name is joined to it by a line.
_ALWAYS = 2.6  # Line width of a leg of every episode, points.


def floor_plan_pictures(results: Results, ward: Ward) -> Iterator[Picture]:
    """A picture a task: the ward with its places, and a panel a patient with the legs of the executed plans."""
    for task in results.tasks:
        legs = {profile: executed_legs(results.of(results.main, profile), task, ward) for profile in results.profiles}
        shown = {profile: each for profile, each in legs.items() if each.counts}
        if shown:
            figure = _draw_plans(ward, shown)
            left_out = sum(each.left_out for each in legs.values())
            yield Picture(f"floor_plan_{task}", f"Where the robot drove: {words(task)}", _caption(left_out), figure)


def _draw_plans(ward: Ward, shown: Mapping[str, ExecutedLegs]) -> Figure:
    """The map with names on the left, the panels beside it, and what the lines mean in the cell that is left."""
    rows = 2 if len(shown) > 1 else 1
    columns = -(-(len(shown) + 1) // rows)
    ratios = [2.2 if rows == 2 else 1.0, *[1.0] * columns]
    legs = sorted({leg for each in shown.values() for leg in each.counts})
    left, bottom, right, top = view = _view(ward, legs)
    height = WIDTH * ratios[0] / sum(ratios) * (top - bottom) / (right - left)
    figure = new_figure(WIDTH, height + 0.25)
    grid = figure.add_gridspec(rows, columns + 1, width_ratios=ratios)
    key = figure.add_subplot(grid[:, 0])
    cells = [figure.add_subplot(grid[i // columns, 1 + i % columns]) for i in range(rows * columns)]
    visited = {name for leg in legs for name in leg}
    places = [place for place in ward.places if place.name in visited]
    for axes in (key, *cells[: len(shown)]):
        _draw_ward(axes, ward, view)
        _mark(axes, places)
    for axes, (profile, each) in zip(cells, shown.items(), strict=False):
        axes.set_title(title_of(profile), color=profile_color(profile), fontsize=7.5)
        _draw_legs(axes, ward, each, profile_color(profile))
    for axes in cells[len(shown) + 1 :]:
        axes.remove()
    _explain(cells[len(shown)])
    key.set_title(ward.name.replace("_", " ").capitalize())
    figure.draw_without_rendering()
    _name_places(key, ward, places, _name_zones(key, ward))
    return figure


def _explain(axes: Axes) -> None:
    """What the width of a line and the shade of the floor mean."""
    from matplotlib.patches import Rectangle

    axes.set_axis_off()
    axes.set_xlim(0, 1)
    axes.set_ylim(0, 1)
    axes.text(0, 0.95, "legs driven in", fontsize=6.5, color=MUTED, va="center")
    for i, share in enumerate((1.0, 0.5, 0.1)):
        y = 0.83 - 0.12 * i
        axes.plot([0, 0.3], [y, y], color=INK, **_line_of(share))
        axes.text(0.38, y, f"{100 * share:.0f} % of episodes", fontsize=6.5, va="center")
    axes.text(0, 0.44, "congestion level", fontsize=6.5, color=MUTED, va="center")
    for i, level in enumerate((0.1, 0.3, 0.8)):
        y = 0.32 - 0.12 * i
        axes.add_patch(Rectangle((0, y - 0.035), 0.3, 0.07, linewidth=0, color=BUSY, alpha=_zone_shade(level)))
        axes.text(0.38, y, f"{level:g}", fontsize=6.5, va="center")


def _caption(left_out: int) -> str:
    text = (
        "Legs of the executed plans, along the routes that the ward's leg planner gives between their places; the "
        "wider a line, the larger the share of episodes that drove it. Shaded floor: congestion zones with their "
        "level, which add risk and slow the robot down."
    )
    if left_out:
        text += f" {left_out} legs that began between places are not drawn, for the record does not tell where."
    return text


def _view(ward: Ward, legs: Sequence[tuple[str, str]]) -> Box:
    """The part of the ward that holds all legs."""
    routes = [route.points for leg in legs if (route := leg_planner(ward).between(*leg)) is not None]
    ends = np.array([(ward.place[name].x, ward.place[name].y) for leg in legs for name in leg])
    points = np.concatenate([ends, *routes])
    outermost = ward.half_extent + ward.wall_half_thickness
    (left, bottom), (right, top) = points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN
    return max(left, -outermost), max(bottom, -outermost), min(right, outermost), min(top, outermost)


def _draw_ward(axes: Axes, ward: Ward, view: Box) -> None:
    """The floor with its zones, and everything solid."""
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
    for level, part in _zone_parts(ward):
        axes.fill(*np.array(part.exterior.coords).T, color=BUSY, alpha=_zone_shade(level), linewidth=0, zorder=1)
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


def _zone_shade(level: float) -> float:
    return 0.06 + 0.4 * level


def _name_zones(axes: Axes, ward: Ward) -> list[Box]:
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
            fontsize=_LABEL_SIZE,
            color=BUSY,
            zorder=3,
            in_layout=False,
        )
        boxes.append(_extent(axes, text))
    return boxes


def _extent(axes: Axes, text: Text) -> Box:
    (left, bottom), (right, top) = axes.transData.inverted().transform(text.get_window_extent())
    return float(left), float(bottom), float(right), float(top)


def _line_of(share: float) -> dict[str, float]:
    """How a leg is drawn that this share of the episodes drove."""
    return {"linewidth": 0.7 + (_ALWAYS - 0.7) * share, "alpha": 0.35 + 0.6 * share}


def _draw_legs(axes: Axes, ward: Ward, legs: ExecutedLegs, color: str) -> None:
    """Rare legs under frequent ones, each with an arrow head in its middle."""
    planner = leg_planner(ward)
    for (start, goal), count in sorted(legs.counts.items(), key=lambda item: (item[1], item[0])):
        route = planner.between(start, goal)
        if route is None:
            continue
        share = min(count / legs.episodes, 1.0)
        points = route.points
        axes.plot(*points.T, color=color, zorder=4, **_line_of(share))
        lengths = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
        tail, head = (tuple(np.interp(lengths[-1] * at, lengths, axis) for axis in points.T) for at in (0.5, 0.52))
        arrow = {"arrowstyle": "-|>", "color": color, "linewidth": 0.6, "mutation_scale": 5 + 2 * share}
        axes.annotate("", head, tail, zorder=5, arrowprops=arrow)


def _mark(axes: Axes, places: Sequence[Place]) -> None:
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


def _name_places(axes: Axes, ward: Ward, places: Sequence[Place], taken: Sequence[Box]) -> None:
    """Writes the names beside the places, clear of one another and, where there is room, of furniture."""
    texts = [
        axes.text(p.x, p.y, words(p.name), fontsize=_LABEL_SIZE, color=INK, zorder=7, in_layout=False) for p in places
    ]
    boxes = [_extent(axes, text) for text in texts]
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
