"""From where places are by the map to where they were learned to be, and where they are (paper, Fig. "target-map")."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.patches import Circle
from numpy.typing import NDArray

from mala_drake.reporting.figures.label_places import Box
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import INK, PAPER, PLACE_COLORS, WIDTH, new_figure
from mala_drake.reporting.figures.ward_plan import draw_ward, mark_places, name_places
from mala_drake.reporting.results import Results
from mala_drake.reporting.target_results import Point, TargetRun, places_of, target_runs
from mala_drake.reporting.wording import title_of, words
from mala_drake.ward.ward_map import Ward

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MARGIN = 3.5  # Metres shown round all that is drawn.
_HALF_VIEW = 5.4  # Metres to each side of a place in its own panel.
_PLATEAU = 1.0  # Metres from a place within which the robot is fully there.
_MOST_COLUMNS = 4


def target_map_pictures(results: Results, ward: Ward) -> Iterator[Picture]:
    """The main condition on the floor plan, and a panel a place under each condition that moves targets."""
    found = {condition: target_runs(results, ward, condition) for condition in results.conditions}
    moving = {name: runs for name, runs in found.items() if any(len(run.targets) > 1 for run in runs)}
    if not moving:
        return
    shown = results.main if results.main in moving else next(iter(moving))
    name = words(results.learner(shown))
    yield Picture("target_map", f"From the map to the true places: {name}", _MAP_CAPTION, _plan(ward, moving[shown]))
    yield Picture("target_paths", "Target by target", _PATHS_CAPTION, _panels(results, ward, moving))


_MAP_CAPTION = (
    "Large dots: places by the map, which planner and controller believe at the beginning. Arrows: to where each run "
    "learned that its legs are to end. Rings: where the place really was in that run, with its seed, which displaces "
    "places in its own way. Furniture stands as on the map; that of a displaced place was moved with it."
)

_PATHS_CAPTION = (
    "Each place by the map in the middle of its panel, 10.8 m wide. Lines: the target from update to update, a line a "
    "run; dots: where it ended. Rings: the plateau of the membership, 1 m round where the place really was in the run, "
    "with a cross in its middle."
)


def _plan(ward: Ward, runs: Sequence[TargetRun]) -> Figure:
    points = np.array([point for run in runs for point in (run.mapped, run.true, run.targets[-1])])
    (left, bottom), (right, top) = points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN
    outermost = ward.half_extent + ward.wall_half_thickness
    view: Box = (max(left, -outermost), max(bottom, -outermost), min(right, outermost), min(top, outermost))
    figure = new_figure(WIDTH, WIDTH * (view[3] - view[1]) / (view[2] - view[0]))
    axes = figure.subplots()
    draw_ward(axes, ward, view, zones=False)
    for run in runs:
        color = PLACE_COLORS[ward.place[run.place].category]
        _ring(axes, run.true, color, radius=0.3)
        _arrow(axes, run.mapped, run.targets[-1], color)
        beyond = np.array(run.true) + 0.55 * _direction(run)
        axes.text(*beyond, str(run.run.seed), color=color, fontsize=5.5, ha="center", va="center", in_layout=False)
    places = [ward.place[name] for name in places_of(runs)]
    mark_places(axes, places)
    figure.draw_without_rendering()
    taken = [box for run in runs for box in _boxes_along(run)]
    name_places(axes, ward, places, taken)
    return figure


def _panels(results: Results, ward: Ward, rows: Mapping[str, Sequence[TargetRun]]) -> Figure:
    places = places_of([run for runs in rows.values() for run in runs])[:_MOST_COLUMNS]
    size = WIDTH / _MOST_COLUMNS
    figure = new_figure(0.3 + size * len(places), 0.3 + size * len(rows))
    grid = figure.subplots(len(rows), len(places), squeeze=False)
    for line, (condition, runs) in enumerate(rows.items()):
        for axes, name in zip(grid[line], places, strict=True):
            place = ward.place[name]
            x, y = place.x, place.y
            draw_ward(axes, ward, (x - _HALF_VIEW, y - _HALF_VIEW, x + _HALF_VIEW, y + _HALF_VIEW), zones=False)
            for run in (run for run in runs if run.place == name):
                _path(axes, run, PLACE_COLORS[place.category])
            mark_places(axes, [place])
        grid[line, 0].set_ylabel(words(results.learner(condition)), color=INK, weight="bold")
    for axes, name in zip(grid[0], places, strict=True):
        axes.set_title(title_of(name), color=PLACE_COLORS[ward.place[name].category])
    return figure


def _path(axes: Axes, run: TargetRun, color: str) -> None:
    _ring(axes, run.true, color, radius=_PLATEAU)
    axes.plot(*run.true, "+", color=color, markersize=4, markeredgewidth=0.8, zorder=4)
    axes.plot(*np.array(run.targets).T, color=INK, linewidth=0.8, zorder=5)
    axes.plot(*np.array(run.targets[1:-1]).reshape(-1, 2).T, ".", color=INK, markersize=2, zorder=5)
    axes.plot(*run.targets[-1], "o", color=INK, markersize=3.2, markeredgecolor=PAPER, markeredgewidth=0.5, zorder=6)


def _direction(run: TargetRun) -> NDArray[np.float64]:
    """From the place by the map to the true one, a unit vector."""
    way = np.subtract(run.true, run.mapped)
    return np.asarray(way / max(float(np.linalg.norm(way)), 1e-9))


def _boxes_along(run: TargetRun) -> list[Box]:
    """Where the arrow, the ring and the seed of a run are, which no name should cover."""
    ways = np.linspace(run.mapped, np.array(run.true) + 0.55 * _direction(run), 12)
    return [(float(x) - 0.3, float(y) - 0.3, float(x) + 0.3, float(y) + 0.3) for x, y in ways]


def _ring(axes: Axes, at: Point, color: str, *, radius: float) -> None:
    axes.add_patch(Circle(at, radius, fill=False, edgecolor=color, linewidth=0.9, zorder=4))


def _arrow(axes: Axes, tail: Point, head: Point, color: str) -> None:
    arrow = {"arrowstyle": "-|>", "color": color, "linewidth": 1.0, "mutation_scale": 7, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", head, tail, zorder=5, arrowprops=arrow)
