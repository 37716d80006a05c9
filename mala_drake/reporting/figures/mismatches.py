"""How far actions were from what was expected of them, in cost (E^C) and in state (E^psi), by episode."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from mala_drake.reporting.figures.curves import aligned, draw_band, episode_locator, label_ends
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import INK, MUTED, PLACE_COLORS, WIDTH, new_figure
from mala_drake.reporting.inner_loop_results import APPROACH, DRIVE, KINDS, WORK, has_actions, mean_size
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.results import Results, Run
from mala_drake.reporting.wording import title_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

KIND_COLORS: Mapping[str, str] = MappingProxyType(
    {APPROACH: PLACE_COLORS["bedside"], DRIVE: PLACE_COLORS["supply"], WORK: PLACE_COLORS["charger"]}
)

_LEAST = 1e-5  # Of the axis of costs: less than that is as good as nothing.
_TICKS = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0)
_PER_MILLE = 1000.0
_MARGIN = 0.3  # Episodes beside the first and the last one.
_DOT_SHIFT = 0.12  # Episodes to each side, so that dots of several runs are told apart.


def mismatch_picture(results: Results) -> Iterator[Picture]:
    """A column a task; costs above, states below; the mean of all actions in ink, each kind in its color."""
    if not has_actions(results, results.main):
        return
    runs = results.of(results.main)
    tasks = [task for task in results.tasks if any(_told(run, task) for run in runs)]
    surprised = any(mean_size(record, "state_mismatch") > 0.0 for run in runs for record in run.episodes)
    figure = new_figure(WIDTH, 4.1 if surprised else 2.7)
    grid = figure.subplots(
        1 + surprised,
        len(tasks),
        squeeze=False,
        sharex="col",
        sharey="row",
        height_ratios=[1.7, 1.0][: 1 + surprised],
    )
    ends = []
    for column, task in zip(grid.T, tasks, strict=True):
        column[0].set_title(title_of(task))
        column[0].set_yscale("log")
        ends.append(_draw(column[0], runs, task, "cost_mismatch"))
        if surprised:
            _draw(column[1], runs, task, "state_mismatch")
        column[-1].set_xlim(1 - _MARGIN, max(len(run.of_task(task)) for run in runs) + _MARGIN)
        column[-1].xaxis.set_major_locator(episode_locator())
        column[-1].set_xlabel(f"{task} episodes")
    _set_up_costs(grid[0, 0])
    if surprised:
        _set_up_states(grid[1, 0])
    figure.draw_without_rendering()
    for axes, labels in zip(grid[0], ends, strict=True):
        label_ends(axes, max(axes.lines[0].get_xdata()), labels)
    yield Picture("mismatches", "How far actions are from what was expected of them", _caption(surprised), figure)


def _caption(surprised: bool) -> str:
    text = (
        "Means over the actions of an episode, medians over runs, with the band between their quartiles for all "
        "actions together. |E^C|, by how much an action cost more or less than the planner predicted when it began, in "
        "thousandths of the plan's metric and on a logarithmic scale. Both costs are features by the weights that the "
        "episode was planned with; the patient's own rating is in neither. What the "
        "planner has learned of what actions cost, where it learns it, is in its prediction. "
    )
    if not surprised:
        return text + "E^ψ, how far the reached state is from the expected one, was 0 after every action."
    return text + (
        "Below: E^ψ, 1 − μ of being where the action was to lead, or 1 if something else is not as expected, such as "
        "the item in the gripper. A dot is a run in which it was not 0."
    )


def _told(run: Run, task: str) -> bool:
    return any(record.executed_actions for record in run.of_task(task))


def _draw(axes: Axes, runs: tuple[Run, ...], task: str, figure: str) -> list[tuple[float, str, str]]:
    """Draws the curves of one figure of actions; returns what to write at their ends."""
    least = _LEAST if figure == "cost_mismatch" else 0.0
    labels = []
    for kind in (*KINDS, None):
        means = aligned([max(mean_size(r, figure, kind), least) for r in run.of_task(task)] for run in runs)
        x, color = range(1, means.shape[1] + 1), INK if kind is None else KIND_COLORS[kind]
        medians = [quantile(column, 0.5) for column in means.T]
        if kind is None:
            draw_band(axes, x, means, INK)
            if figure == "state_mismatch":
                _draw_dots(axes, means)
        else:
            marker = "o" if len(medians) == 1 else ""
            axes.plot(x, medians, color=color, linewidth=1.0, marker=marker, markersize=3)
        if np.isfinite(medians[-1]):
            labels.append((medians[-1], "all" if kind is None else kind, color))
    return labels


def _draw_dots(axes: Axes, means: np.ndarray) -> None:
    """A dot where a run's mean is above 0; words where none ever is."""
    if not (means > 0.0).any():
        axes.text(0.5, 0.5, "0 after every action", transform=axes.transAxes, color=MUTED, fontsize=6.5, ha="center")
        return
    shifts = np.linspace(-_DOT_SHIFT, _DOT_SHIFT, len(means)) if len(means) > 1 else np.zeros(1)
    for shift, row in zip(shifts, means, strict=True):
        (hit,) = np.nonzero(row > 0.0)
        axes.plot(hit + 1 + shift, row[hit], ".", color=INK, markersize=4.5, alpha=0.45, markeredgewidth=0)


def _set_up_costs(axes: Axes) -> None:
    axes.yaxis.set_major_locator(FixedLocator(_TICKS))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{_PER_MILLE * value:g}"))
    axes.set_ylabel("|E$^C$|, thousandths")
    axes.set_ylim(bottom=_LEAST)


def _set_up_states(axes: Axes) -> None:
    axes.set_ylabel("E$^ψ$")
    axes.set_ylim(0.0, max(0.1, 1.05 * axes.get_ylim()[1]))
