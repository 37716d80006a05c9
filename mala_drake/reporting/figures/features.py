"""Which features the executed plans had: their distribution by patient and task."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from mala_drake.preferences import CRITERIA
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import CRITERION_COLORS, PAPER, WIDTH, new_figure, profile_color
from mala_drake.reporting.quantiles import spread
from mala_drake.reporting.results import Results
from mala_drake.reporting.wording import title_of, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TICK = 0.2  # Half the height of an episode's tick, in lines.


def feature_picture(results: Results) -> Iterator[Picture]:
    """A row a task, a column a criterion; in each, a line a patient with median, quartiles and every episode."""
    tasks, profiles = results.tasks, results.profiles
    figure = new_figure(WIDTH, 0.4 + len(tasks) * (0.5 + 0.21 * len(profiles)))
    grid = figure.subplots(len(tasks), len(CRITERIA), squeeze=False, sharex=True, sharey=True)
    for row, task in zip(grid, tasks, strict=True):
        for axes, criterion in zip(row, CRITERIA, strict=True):
            for line, profile in enumerate(profiles):
                done = [r for run in results.of(results.main, profile) for r in run.of_task(task) if r.success]
                _draw_line(axes, line, [record.features[criterion] for record in done], profile_color(profile))
        row[0].set_ylabel(title_of(task), weight="bold")
    for axes, criterion in zip(grid[0], CRITERIA, strict=True):
        axes.set_title(title_of(criterion), color=CRITERION_COLORS[criterion])
    first = grid[0][0]
    first.set_xlim(-0.03, 1.03)
    first.set_xticks([0.0, 0.5, 1.0], ["0", "0.5", "1"])
    first.set_yticks(range(len(profiles)), [words(profile) for profile in profiles])
    first.set_ylim(len(profiles) - 0.5, -0.5)
    for axes in grid.ravel():
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="y", visible=False)
        axes.spines["left"].set_visible(False)
    caption = (
        "Features measured on the executed trajectories, 0 best and 1 worst, of all seeds and of all episodes in which "
        "the task was done. A tick is an episode, a bar reaches between the quartiles, a ring is the median."
    )
    yield Picture("features", "What the executed plans cost", caption, figure)


def _draw_line(axes: Axes, line: int, values: list[float], color: str) -> None:
    if not values:
        return
    ticks = np.full((len(values), 3, 2), np.nan)  # All ticks as one path: thousands of markers make a heavy picture.
    ticks[:, :2, 0] = np.array(values)[:, None]
    ticks[:, :2, 1] = line - _TICK, line + _TICK
    axes.plot(*ticks.reshape(-1, 2).T, color=color, alpha=0.45, linewidth=0.6)
    figures = spread(values)
    axes.plot([figures.lower, figures.upper], [line, line], color=color, linewidth=3.0)
    axes.plot(
        figures.median, line, "o", markersize=4.5, markerfacecolor=PAPER, markeredgecolor=color, markeredgewidth=1.3
    )
