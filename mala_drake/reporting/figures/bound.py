"""How much of what could be learned has been: errors against the information bound."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from mala_drake.reporting.bound_results import bounds_of, error_over_bound, rating_noise
from mala_drake.reporting.figures.curves import episode_locator, label_ends
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import INK, MUTED, PAPER, WIDTH, new_figure, profile_color
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.result_tables import compared_conditions
from mala_drake.reporting.results import Results
from mala_drake.reporting.wording import words

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def bound_picture(results: Results) -> Iterator[Picture]:
    """Error over bound by episode, and the final distance of each run beside the one that the bound allows."""
    noise = rating_noise(results, results.main)
    if noise is None or not any(results.true_weights(profile) for profile in results.profiles):
        return
    figure = new_figure(WIDTH, 2.5)
    left, right = figure.subplots(1, 2, width_ratios=[1.25, 1.0])
    ends = _draw_ratios(left, results)
    _draw_distances(right, results, noise)
    figure.draw_without_rendering()
    label_ends(left, left.get_xlim()[1], ends)
    caption = (
        "Left: root mean square, over all runs and weights, of the error divided by the information bound, the least "
        "standard deviation that an unbiased estimate from the same rated episodes can have on the simplex (Cramér and "
        f"Rao; rating noise {noise:g}); it is drawn as long as all runs last. Right: the final distance of each run "
        "(points, ring: median) and what the bound allows (bar: median over runs)."
    )
    yield Picture("bound", "How much of what could be learned was learned", caption, figure)


def _draw_ratios(axes: Axes, results: Results) -> list[tuple[float, str, str]]:
    """Draws a curve a learner; returns what to write at their ends."""
    ends = []
    for condition in reversed(compared_conditions(results)):
        ratios = error_over_bound(results, condition)
        known = ratios[np.isfinite(ratios)]
        if not known.size:
            continue
        color = INK if condition == results.main else MUTED
        marker = "o" if known.size == 1 else ""
        axes.plot(range(1, ratios.size + 1), ratios, color=color, marker=marker, markersize=3)
        ends.append((float(known[-1]), f"{words(results.learner(condition))}: {known[-1]:.2f}", color))
    axes.axhline(1.0, color=INK, linewidth=0.7, dashes=(4, 3))
    axes.set_title("Error / bound (dashed: 1)")
    axes.set_ylim(bottom=0.0)
    axes.set_xlim(left=0)
    axes.xaxis.set_major_locator(episode_locator())
    axes.set_xlabel("episodes")
    return ends


def _draw_distances(axes: Axes, results: Results, noise: float) -> None:
    for row, profile in enumerate(results.profiles):
        runs, color = results.of(results.main, profile), profile_color(profile)
        finals = [run.learning.final_distance for run in runs]
        allowed = float(np.median([np.linalg.norm(bounds_of(run, noise)[-1]) for run in runs]))
        axes.plot(finals, [row] * len(finals), "o", color=color, alpha=0.5, markersize=3, markeredgewidth=0)
        axes.plot(quantile(finals, 0.5), row, "o", markersize=5, markerfacecolor=PAPER, markeredgecolor=color, zorder=4)
        if np.isfinite(allowed):
            axes.plot([allowed] * 2, [row - 0.33, row + 0.33], color=INK, linewidth=1.4)
    axes.set_title("Final distance")
    axes.set_yticks(range(len(results.profiles)), [words(profile) for profile in results.profiles])
    axes.set_ylim(len(results.profiles) - 0.5, -0.5)
    axes.set_xlim(left=0.0)
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="y", visible=False)
    axes.spines["left"].set_visible(False)
