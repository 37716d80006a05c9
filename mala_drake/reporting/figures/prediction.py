"""How well the planner predicted what an episode then cost: |predicted - measured feature| by episode."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.preferences import CRITERIA
from mala_drake.reporting.figures.curves import aligned, draw_band, episode_locator, label_ends
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import CRITERION_COLORS, INK, WIDTH, grid_of_axes, new_figure
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.results import Results
from mala_drake.reporting.wording import title_of


def prediction_error(record: EpisodeRecord, criterion: str) -> float:
    """The error of one feature; NaN where it was not predicted or not measured, or the task was not finished."""
    if not record.success:
        return np.nan  # What was left undone was neither measured nor executed.
    return abs(record.predicted_features.get(criterion, np.nan) - record.features.get(criterion, np.nan))


def prediction_picture(results: Results) -> Iterator[Picture]:
    """The error by episode of each task: the mean of the five features in ink, each feature in its color."""
    tasks = results.tasks
    figure = new_figure(WIDTH, 2.5)
    all_axes = grid_of_axes(figure, len(tasks), len(tasks), sharey=True)
    ends = []
    for axes, task in zip(all_axes, tasks, strict=True):
        axes.set_title(title_of(task))
        episodes = [run.of_task(task) for run in results.of(results.main)]
        by_criterion = [
            aligned([prediction_error(record, criterion) for record in records] for records in episodes)
            for criterion in CRITERIA
        ]
        x = range(1, by_criterion[0].shape[1] + 1)
        labels = []
        for criterion, errors in zip(CRITERIA, by_criterion, strict=True):
            medians = [quantile(column, 0.5) for column in errors.T]
            marker = "o" if len(medians) == 1 else ""
            axes.plot(x, medians, color=CRITERION_COLORS[criterion], linewidth=1.0, marker=marker, markersize=3)
            labels.append((medians[-1], criterion, CRITERION_COLORS[criterion]))
        mean = np.mean(by_criterion, axis=0)
        draw_band(axes, x, mean, INK)
        labels.append((quantile(mean[:, -1], 0.5), "mean", INK))
        axes.xaxis.set_major_locator(episode_locator())
        axes.set_xlabel(f"{task} episodes")
        ends.append([label for label in labels if np.isfinite(label[0])])
    all_axes[0].set_ylabel("|predicted − measured|")
    all_axes[0].set_ylim(bottom=0)
    figure.draw_without_rendering()
    for axes, labels in zip(all_axes, ends, strict=True):
        label_ends(axes, max(axes.lines[0].get_xdata()), labels)
    caption = (
        "The planner's error in the five features of an episode, each between 0 and 1: medians over all runs; the mean "
        "of the five with the band between its quartiles. Unfinished episodes are left out."
    )
    yield Picture("prediction", "How well the planner knows what it will cost", caption, figure)
