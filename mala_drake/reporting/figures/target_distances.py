"""How far learned targets are from the true places, update by update (paper, Fig. "target-convergence")."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import BUSY, INK, MUTED, PLACE_COLORS, WIDTH, new_figure
from mala_drake.reporting.paper_results import PAPER_TARGET_UPDATES
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.results import Results
from mala_drake.reporting.target_results import TargetRun, places_of, target_runs
from mala_drake.reporting.wording import title_of, words
from mala_drake.ward.ward_map import Ward

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LEAST = 0.01  # Metres; the distance axis begins there.
_TICKS = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0)
_LIMITS = ((1.0, "on the plateau, 1 m"), (0.15, "0.15 m"))
_MOST_COLUMNS = 4


def target_distance_picture(results: Results, ward: Ward) -> Iterator[Picture]:
    """A row a condition that moves targets, a panel a place: thin lines of each run, and their median."""
    found = {condition: target_runs(results, ward, condition) for condition in results.conditions}
    rows = {name: runs for name, runs in found.items() if any(len(run.targets) > 1 for run in runs)}
    places = places_of([run for runs in rows.values() for run in runs])[:_MOST_COLUMNS]
    if not rows:
        return
    figure = new_figure(WIDTH, 0.55 + 1.65 * len(rows))
    grid = figure.subplots(len(rows), len(places), sharex=True, sharey=True, squeeze=False)
    for line, (condition, runs) in enumerate(rows.items()):
        for axes, place in zip(grid[line], places, strict=True):
            _draw(axes, [run for run in runs if run.place == place], PLACE_COLORS[ward.place[place].category])
            _set_up(axes, place)
        grid[line, 0].set_ylabel(words(results.learner(condition)), color=INK, weight="bold")
    for axes, place in zip(grid[0], places, strict=True):
        axes.set_title(title_of(place), color=PLACE_COLORS[ward.place[place].category])
    grid[0, 0].set_xlim(left=0)
    figure.supxlabel("updates of the target", fontsize=7.5, color=MUTED)
    figure.supylabel("distance to the true place, m", fontsize=7.5, color=MUTED)
    figure.draw_without_rendering()
    for axes, place in zip(grid[0], places, strict=True):
        _name_paper(axes, place)
    _name_limits(grid[0, -1])
    yield Picture("target_distance", "How fast places are found", _caption(results, rows, found), figure)


def _draw(axes: Axes, runs: Sequence[TargetRun], color: str) -> None:
    """A run's target stays where its last update put it, so that the median is always over all runs."""
    if not runs:
        axes.text(0.5, 0.5, "never driven to", transform=axes.transAxes, color=MUTED, fontsize=6.5, ha="center")
        return
    longest = max(len(run.targets) for run in runs)
    values = np.array([np.pad(run.distances, (0, longest - len(run.targets)), mode="edge") for run in runs])
    for run in runs:
        shown = np.maximum(run.distances, _LEAST)
        axes.plot(shown, color=color, linewidth=0.6, alpha=0.6)
        axes.plot(len(shown) - 1, shown[-1], ".", color=color, markersize=3.5, alpha=0.8, clip_on=False)
    medians = [max(quantile(column, 0.5), _LEAST) for column in values.T]
    axes.plot(medians, color=color, linewidth=1.8, marker="o" if longest == 1 else "", markersize=3)


def _set_up(axes: Axes, place: str) -> None:
    axes.set_yscale("log")
    axes.set_ylim(_LEAST, 6.0)
    axes.yaxis.set_major_locator(FixedLocator(_TICKS))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_major_locator(FixedLocator(range(0, 101, 5)))
    for limit, _ in _LIMITS:
        axes.axhline(limit, color=INK, linewidth=0.6, dashes=(4, 3))
    if place in PAPER_TARGET_UPDATES:
        first, last = PAPER_TARGET_UPDATES[place]
        axes.axvspan(first - 0.25, last + 0.25, color=BUSY, alpha=0.25, linewidth=0)


def _name_paper(axes: Axes, place: str) -> None:
    if place not in PAPER_TARGET_UPDATES:
        return
    first, last = PAPER_TARGET_UPDATES[place]
    text = f"paper: {first}–{last}" if first < last else f"paper: about {first}"
    axes.annotate(
        text,
        (first - 0.25, _TICKS[-1]),
        (-3, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        color=BUSY,
        fontsize=6.5,
    )


def _name_limits(axes: Axes) -> None:
    right = axes.get_xlim()[1]
    for limit, text in _LIMITS:
        axes.annotate(text, (right, limit), (-2, 2), textcoords="offset points", ha="right", fontsize=6)


def _caption(
    results: Results, rows: Mapping[str, Sequence[TargetRun]], found: Mapping[str, Sequence[TargetRun]]
) -> str:
    text = (
        "Distance from the learned target to where the place really is, on a logarithmic scale: before any update, as "
        "far as the map is off, and after each one. Thin: each run, up to its last update; thick: the median. "
        "Dashed: the edge of the membership's plateau, and 0.15 m. Shaded: after how many updates the paper's targets "
        "came to rest (judged by their own last values)."
    )
    still = [words(results.learner(condition)) for condition in found if condition not in rows and found[condition]]
    return text + (f" Under {' and '.join(still)} no target ever moves." if still else "")
