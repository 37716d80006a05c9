"""What has been learned: weights by episode with their intervals, and final weights against true ones."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import MultipleLocator

from mala_drake.preferences import CRITERIA
from mala_drake.reporting.figures.curves import aligned, draw_band, episode_locator, label_ends
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import (
    CRITERION_COLORS,
    INK,
    MUTED,
    WIDTH,
    grid_of_axes,
    new_figure,
    profile_color,
)
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.results import Results, Run
from mala_drake.reporting.wording import title_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_INTERVAL = 1.645  # Standard deviations to each side of the 90 % interval of a normal distribution.


def trajectory_picture(results: Results) -> Iterator[Picture]:
    """The five weights by episode, a panel a profile, with the true ones dashed."""
    profiles = results.profiles
    columns = min(len(profiles), 2)
    figure = new_figure(WIDTH, 0.3 + 2.1 * -(-len(profiles) // columns))
    all_axes = grid_of_axes(figure, len(profiles), columns, sharey=True)
    for axes, profile in zip(all_axes, profiles, strict=True):
        axes.set_title(title_of(profile), color=profile_color(profile))
        _draw_trajectories(axes, results.of(results.main, profile))
        axes.yaxis.set_major_locator(MultipleLocator(0.2))
        axes.xaxis.set_major_locator(episode_locator())
        axes.set_xlim(0, max(len(run.episodes) for run in results.of(results.main, profile)))
    highest = max((max(results.true_weights(profile) or (0.0,)) for profile in profiles), default=0.0)
    all_axes[0].set_ylim(0.0, max(all_axes[0].get_ylim()[1], 1.05 * highest))
    figure.supxlabel("episodes", fontsize=7.5, color=MUTED)
    figure.supylabel("weight", fontsize=7.5, color=MUTED)
    figure.draw_without_rendering()
    for axes, profile in zip(all_axes, profiles, strict=True):
        _draw_truth(axes, results, profile)
    caption = "Learned weights: median over seeds. Dashed: the true weights. " + (
        "Bands: the learner's own 90 % credible interval (median over seeds of its width)."
        if _tells_deviations(results)
        else "Bands: between the quartiles over seeds; this learner is a point estimate and gives no interval."
    )
    yield Picture("weights", "What was learned, and how sure the robot is of it", caption, figure)


def _tells_deviations(results: Results) -> bool:
    return any(record.weights_std for run in results.of(results.main) for record in run.episodes)


def _weights(run: Run, criterion: int) -> list[float]:
    return [run.episodes[0].weights_before[criterion], *(record.weights_after[criterion] for record in run.episodes)]


def _deviations(run: Run, criterion: int) -> list[float]:
    """After each episode; before the first one nothing tells how sure the learner was."""
    return [np.nan, *(record.weights_std[criterion] if record.weights_std else np.nan for record in run.episodes)]


def _draw_trajectories(axes: Axes, runs: tuple[Run, ...]) -> None:
    for criterion, name in enumerate(CRITERIA):
        color = CRITERION_COLORS[name]
        values = aligned(_weights(run, criterion) for run in runs)
        deviations = aligned(_deviations(run, criterion) for run in runs)
        if np.isnan(deviations).all():
            draw_band(axes, range(values.shape[1]), values, color)
            continue
        middle = np.array([quantile(column, 0.5) for column in values.T])
        reach = _INTERVAL * np.array([quantile(column, 0.5) for column in deviations.T])
        axes.fill_between(
            range(middle.size), np.maximum(middle - reach, 0.0), middle + reach, color=color, alpha=0.2, linewidth=0
        )
        axes.plot(middle, color=color)


def _draw_truth(axes: Axes, results: Results, profile: str) -> None:
    """True weights as dashed lines, and the criteria named beside them (or beside the ends, if there is no truth)."""
    true = results.true_weights(profile)
    ends = []
    for criterion, name in enumerate(CRITERIA):
        if true is not None:
            axes.axhline(true[criterion], color=CRITERION_COLORS[name], linewidth=0.9, dashes=(4, 3))
        last = quantile((run.final.weights_after[criterion] for run in results.of(results.main, profile)), 0.5)
        ends.append((last if true is None else true[criterion], name, CRITERION_COLORS[name]))
    label_ends(axes, axes.get_xlim()[1], ends)


def final_weights_picture(results: Results) -> Iterator[Picture]:
    """Final weights as bars with their spread over seeds, true ones as diamonds."""
    profiles = results.profiles
    figure = new_figure(WIDTH, 2.3)
    all_axes = grid_of_axes(figure, len(profiles), len(profiles), sharey=True)
    for axes, profile in zip(all_axes, profiles, strict=True):
        axes.set_title(title_of(profile).replace(" ", "\n", 1), color=profile_color(profile))
        _draw_final(axes, results, profile)
    all_axes[0].set_ylabel("weight")
    caption = (
        "Final weights: bars are medians over seeds, whiskers reach from the least to the greatest of them. Diamonds: "
        "the true weights."
    )
    yield Picture("final_weights", "Final against true weights", caption, figure)


def _draw_final(axes: Axes, results: Results, profile: str) -> None:
    true = results.true_weights(profile)
    runs = results.of(results.main, profile)
    for criterion, name in enumerate(CRITERIA):
        finals = [run.final.weights_after[criterion] for run in runs]
        axes.bar(criterion, quantile(finals, 0.5), width=0.72, color=CRITERION_COLORS[name], alpha=0.55, linewidth=0)
        axes.plot([criterion] * 2, [min(finals), max(finals)], color=CRITERION_COLORS[name], linewidth=1.4)
        if true is not None:
            axes.plot(criterion, true[criterion], marker="D", markersize=4, color=INK, zorder=4)
    axes.set_xticks(range(len(CRITERIA)), CRITERIA, rotation=90)
    axes.tick_params(axis="x", length=0)
    axes.grid(axis="x", visible=False)
