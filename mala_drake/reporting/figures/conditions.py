"""Conditions beside each other: how far from the truth each ends, and what its plans cost the patient."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import INK, MUTED, WIDTH, new_figure, profile_color
from mala_drake.reporting.profile_results import ProfileResults, profile_results
from mala_drake.reporting.quantiles import Spread
from mala_drake.reporting.result_tables import changes_of_mind
from mala_drake.reporting.results import Results
from mala_drake.reporting.wording import words

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def condition_picture(results: Results) -> Iterator[Picture]:
    """A line a condition, a point a patient: final distance, and the true cost of the executed plans."""
    figures = {condition: profile_results(results, condition) for condition in results.conditions}
    if len(figures) < 2:
        return
    profiles = list(dict.fromkeys(each.profile for of_condition in figures.values() for each in of_condition))
    figure = new_figure(WIDTH, 0.75 + 0.3 * len(figures))
    left, right = figure.subplots(1, 2, sharey=True)
    _draw(left, figures, profiles, lambda each: each.final_distance)
    _draw(right, figures, profiles, lambda each: each.cost)
    left.set_title("Final distance to the true weights")
    right.set_title("What the plans cost the patient, w*·f")
    left.set_xlim(left=0)
    names = [words(results.learner(condition)) for condition in figures]
    left.set_yticks(range(len(names)), names)
    left.set_ylim(len(names) - 0.5, -0.5)
    left.get_yticklabels()[0].set_fontweight("bold")
    for label in left.get_yticklabels():
        label.set_color(INK)
    for number, profile in enumerate(profiles):
        right.annotate(
            words(profile),
            (1, 1),
            (8, -4 - 10 * number),
            xycoords="axes fraction",
            textcoords="offset points",
            color=profile_color(profile),
            fontsize=7,
            weight="bold",
            va="top",
        )
    caption = (
        "Medians over seeds by patient, with bars between the quartiles; the first line is the main condition. Costs "
        "are of an average episode in which the task was done."
    ) + changes_of_mind(results, results.conditions)
    yield Picture("conditions", "What each part is worth", caption, figure)


def _draw(
    axes: Axes,
    figures: dict[str, tuple[ProfileResults, ...]],
    profiles: list[str],
    of: Callable[[ProfileResults], Spread],
) -> None:
    step = 0.6 / max(len(profiles), 1)
    for line, of_condition in enumerate(figures.values()):
        for each in of_condition:
            y = line + step * (profiles.index(each.profile) - (len(profiles) - 1) / 2)
            color, spread = profile_color(each.profile), of(each)
            axes.plot([spread.lower, spread.upper], [y, y], color=color, linewidth=1.6)
            axes.plot(spread.median, y, "o", color=color, markersize=3.6)
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="y", visible=False)
    axes.spines["left"].set_visible(False)
    for line in range(1, len(figures)):
        axes.axhline(line - 0.5, color=MUTED, linewidth=0.3)
