"""How the weights of the controller's cost moved, by where a leg leads (p^g)."""

from __future__ import annotations

from collections.abc import Iterator

from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from mala_drake.learning.weight_estimator import WEIGHT_GROUPS
from mala_drake.reporting.figures.curves import aligned, draw_band, episode_locator, label_ends
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import CRITERION_COLORS, MUTED, WIDTH, grid_of_axes, new_figure
from mala_drake.reporting.inner_loop_results import factor_course, factor_places, learning_condition, under
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.results import Results
from mala_drake.reporting.wording import title_of

_COLORS = dict(
    zip(WEIGHT_GROUPS, (CRITERION_COLORS[c] for c in ("time", "approach", "safety", "battery")), strict=True)
)
_TICKS = (0.25, 0.5, 1.0, 2.0, 4.0)
_COLUMNS = 3
_MOST_PLACES = 9


def factor_picture(results: Results) -> Iterator[Picture]:
    """A panel a place, a line a group of weights."""
    condition = learning_condition(results, "learned_weights")
    if condition is None:
        return
    runs, places = results.of(condition), factor_places(results, condition)
    shown = places[:_MOST_PLACES]
    figure = new_figure(WIDTH, 0.35 + 1.75 * -(-len(shown) // _COLUMNS))
    all_axes = grid_of_axes(figure, len(shown), _COLUMNS, sharex=True, sharey=True)
    for axes, place in zip(all_axes, shown, strict=True):
        axes.set_title(title_of(place))
        axes.set_yscale("log")
        axes.axhline(1.0, color=MUTED, linewidth=0.8, dashes=(1.5, 2.5))
        for number, group in enumerate(WEIGHT_GROUPS):
            courses = aligned(factor_course(run, place, number) for run in runs)
            draw_band(axes, range(courses.shape[1]), courses, _COLORS[group])
        axes.xaxis.set_major_locator(episode_locator())
    first, longest = all_axes[0], max(len(run.episodes) for run in runs)
    first.yaxis.set_major_locator(FixedLocator(_TICKS))
    first.yaxis.set_minor_locator(NullLocator())
    first.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    first.set_ylim(min(first.get_ylim()[0], 0.5), max(first.get_ylim()[1], 2.0))
    first.set_xlim(0, longest)
    figure.supxlabel("episodes", fontsize=7.5, color=MUTED)
    figure.supylabel("factor", fontsize=7.5, color=MUTED)
    figure.draw_without_rendering()
    for axes, place in zip(all_axes, shown, strict=True):
        ends = [
            (quantile((factor_course(run, place, i)[-1] for run in runs), 0.5), group, _COLORS[group])
            for i, group in enumerate(WEIGHT_GROUPS)
        ]
        label_ends(axes, longest, ends, size=6.5)
    more = len(places) - len(shown)
    caption = (
        "Factors on the weights of the controller's cost (position, yaw, velocity, control) by where a leg leads, "
        "after each episode, on a logarithmic scale: median over runs and the band between the quartiles. They move "
        "along the closed-loop gradient such that |E^C| falls; a step after which it has not fallen is taken back. "
        "Their product is 1, since a common factor changes nothing."
        + (f" {more} more places, of the fewest runs, are left out." if more else "")
    )
    yield Picture(
        "weight_factors", "What the controller minds, place by place", caption + under(results, condition), figure
    )
