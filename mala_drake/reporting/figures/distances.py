"""How far the learned preferences are from the true ones, episode by episode (paper, Fig. "weight-distance")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from mala_drake.learning.convergence import CONVERGED_DISTANCE, preference_distance
from mala_drake.reporting.figures.curves import aligned, draw_band, episode_locator, label_ends
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import INK, MUTED, WIDTH, grid_of_axes, new_figure, profile_color
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.result_tables import compared_conditions
from mala_drake.reporting.results import Results, Run
from mala_drake.reporting.wording import title_of, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LEAST = 5e-3  # Of the distance axis: less than that is as good as nothing.
_TICKS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)


def distance_pictures(results: Results) -> Iterator[Picture]:
    """The distance to the true weights: a panel a profile, and the medians of all of them together."""
    conditions = compared_conditions(results)
    profiles = results.profiles
    together = len(profiles) > 1
    count = len(profiles) + together
    columns = min(count, 3)
    figure = new_figure(WIDTH, 0.35 + 2.0 * -(-count // columns))
    all_axes = grid_of_axes(figure, count, columns, sharex=True, sharey=True)
    for axes, profile in zip(all_axes, profiles, strict=False):
        axes.set_title(title_of(profile), color=profile_color(profile))
        for condition in reversed(conditions):
            color = profile_color(profile) if condition == results.main else MUTED
            _draw(axes, results.of(condition, profile), results, color)
        _set_up(axes)
    if together:
        all_axes[-1].set_title("All, medians")
        _set_up(all_axes[-1])
    figure.supxlabel("episodes", fontsize=7.5, color=MUTED)
    figure.supylabel("distance to the true weights", fontsize=7.5, color=MUTED)
    figure.draw_without_rendering()  # Labels are placed in points, so the limits have to be known.
    if together:
        _draw_medians(all_axes[-1], results)
    _name_lines(all_axes[0], results, conditions)
    yield Picture("distance", "How fast the patient is understood", _caption(results, conditions), figure)


def _distances(run: Run, results: Results) -> list[float]:
    """Before the first episode, where what was wanted then is known, and after each."""
    true = None if run.earlier_episodes else results.true_weights(run.profile)
    before = float("nan") if true is None else preference_distance(run.episodes[0].weights_before, true)
    return [max(distance, _LEAST) for distance in (before, *(record.distance_to_true for record in run.episodes))]


def _draw(axes: Axes, runs: tuple[Run, ...], results: Results, color: str) -> None:
    if runs:
        values = aligned(_distances(run, results) for run in runs)
        draw_band(axes, range(values.shape[1]), values, color)


def _set_up(axes: Axes) -> None:
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(FixedLocator(_TICKS))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_major_locator(episode_locator())
    axes.axhline(CONVERGED_DISTANCE, color=INK, linewidth=0.7, dashes=(4, 3))
    axes.set_xlim(left=0)
    axes.margins(x=0)


def _draw_medians(axes: Axes, results: Results) -> None:
    ends = []
    for profile in results.profiles:
        values = aligned(_distances(run, results) for run in results.of(results.main, profile))
        medians = [quantile(column, 0.5) for column in values.T]
        axes.plot(medians, color=profile_color(profile), linewidth=1.1)
        ends.append((medians[-1], words(profile).split()[0], profile_color(profile)))
    label_ends(axes, axes.get_xlim()[1], ends)


def _name_lines(axes: Axes, results: Results, conditions: tuple[str, ...]) -> None:
    """Says in the first panel what the dashed line is, and which learner is which."""
    right = axes.get_xlim()[1]
    axes.annotate(
        f"converged: {CONVERGED_DISTANCE:g}",
        (right, CONVERGED_DISTANCE),
        (0, 2),
        textcoords="offset points",
        ha="right",
        fontsize=6.5,
    )
    if len(conditions) < 2:
        return
    for i, condition in enumerate(conditions):
        color = profile_color(results.profiles[0]) if condition == results.main else MUTED
        axes.annotate(
            words(results.learner(condition)),
            (1, 1),
            (0, -2 - 9 * i),
            xycoords="axes fraction",
            textcoords="offset points",
            ha="right",
            va="top",
            color=color,
            fontsize=6.5,
            weight="bold",
        )


def _caption(results: Results, conditions: tuple[str, ...]) -> str:
    text = (
        "Distance d = ‖ŵ − w*‖ between learned and true weights after each episode, on a logarithmic scale: median "
        f"over seeds and the band between the quartiles. Dashed: the threshold of convergence, {CONVERGED_DISTANCE:g}."
    )
    if len(conditions) > 1:
        others = " and ".join(words(results.learner(condition)) for condition in conditions[1:])
        text += f" In color {words(results.learner(results.main))}, in grey {others}."
    return text
