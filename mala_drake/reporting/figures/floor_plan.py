"""The ward from above, with the ways the robot took for each patient (paper, Fig. "floor_plan")."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from mala_drake.reporting.executed_legs import ExecutedLegs, executed_legs
from mala_drake.reporting.figures.label_places import Box
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import BUSY, INK, MUTED, WIDTH, new_figure, profile_color
from mala_drake.reporting.figures.ward_plan import draw_ward, mark_places, name_places, name_zones, zone_shade
from mala_drake.reporting.results import Results
from mala_drake.reporting.wording import title_of, words
from mala_drake.ward.legs import leg_planner
from mala_drake.ward.ward_map import Ward

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MARGIN = 3.0  # Metres shown round the legs.
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
        draw_ward(axes, ward, view)
        mark_places(axes, places)
    for axes, (profile, each) in zip(cells, shown.items(), strict=False):
        axes.set_title(title_of(profile), color=profile_color(profile), fontsize=7.5)
        _draw_legs(axes, ward, each, profile_color(profile))
    for axes in cells[len(shown) + 1 :]:
        axes.remove()
    _explain(cells[len(shown)])
    key.set_title(ward.name.replace("_", " ").capitalize())
    figure.draw_without_rendering()
    name_places(key, ward, places, name_zones(key, ward))
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
        axes.add_patch(Rectangle((0, y - 0.035), 0.3, 0.07, linewidth=0, color=BUSY, alpha=zone_shade(level)))
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
