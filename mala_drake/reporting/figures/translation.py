"""How the translation from preferences to the weights of the controller's cost moved (paper, the translator)."""

from __future__ import annotations

from collections.abc import Iterator

from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION
from mala_drake.preferences import CRITERIA
from mala_drake.reporting.figures.curves import aligned, draw_band, episode_locator, label_ends
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import CRITERION_COLORS, MUTED, WIDTH, grid_of_axes, new_figure
from mala_drake.reporting.inner_loop_results import gain_course, learning_condition, under
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.results import Results

ENTRIES = ("x", "y", "yaw", "forward velocity", "lateral velocity", "yaw rate", "propulsion", "brake", "turning")
"""Of the diagonals of Q and R, in the order of the gains."""

_COLUMNS = 3


def translation_picture(results: Results) -> Iterator[Picture]:
    """A panel an entry of Q or R, a line a preference."""
    condition = learning_condition(results, "learned_translation")
    if condition is None:
        return
    runs, starts = results.of(condition), DEFAULT_TRANSLATION.gains
    longest = max(len(run.episodes) for run in runs)
    figure = new_figure(WIDTH, 4.6)
    all_axes = grid_of_axes(figure, len(ENTRIES), _COLUMNS, sharex=True, sharey=True)
    ends = []
    for row, (axes, entry) in enumerate(zip(all_axes, ENTRIES, strict=True)):
        axes.set_title(f"{'Q' if row < 6 else 'R'}: {entry}")
        labels = []
        for column, criterion in enumerate(CRITERIA):
            courses = aligned(gain_course(run, row, column, starts[row, column]) for run in runs)
            draw_band(axes, range(courses.shape[1]), courses, CRITERION_COLORS[criterion])
            labels.append((quantile(courses[:, -1], 0.5), criterion, CRITERION_COLORS[criterion]))
        axes.xaxis.set_major_locator(episode_locator())
        ends.append(labels)
    all_axes[0].set_xlim(0, longest)
    figure.supxlabel("episodes", fontsize=7.5, color=MUTED)
    figure.supylabel("change of the gain", fontsize=7.5, color=MUTED)
    figure.draw_without_rendering()
    for axes, labels in zip(all_axes, ends, strict=True):
        label_ends(axes, longest, labels, size=6.0)
    caption = (
        "Each diagonal entry of the controller's Q and R is its working point times 1 + Σ gain (w − 1/5) over the five "
        "preferences w. By how much each gain (0, 2 or 3 at first) has moved after each episode: median over runs and "
        "the band between the quartiles. Every leg moves them a little along the closed-loop gradient, such that |E^C| "
        "falls."
    )
    yield Picture("translation", "How wishes become weights", caption + under(results, condition), figure)
