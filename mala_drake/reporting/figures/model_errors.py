"""How well the controller's model predicts the robot a tick ahead, as learned and as it was, by episode."""

from __future__ import annotations

from collections.abc import Iterator

from mala_drake.reporting.figures.curves import aligned, draw_band, episode_locator
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import CRITERION_COLORS, MUTED, WIDTH, grid_of_axes, new_figure
from mala_drake.reporting.inner_loop_results import learning_condition, model_error, under
from mala_drake.reporting.results import Results

_VELOCITIES = ("Forward, mm/s", "Sideways, mm/s", "Turning, mrad/s")
_COLORS = {"nominal": MUTED, "learned": CRITERION_COLORS["time"]}
_MILLI = 1000.0


def model_error_picture(results: Results) -> Iterator[Picture]:
    """A panel a velocity."""
    condition = learning_condition(results, "dynamics_errors")
    if condition is None:
        return
    runs = results.of(condition)
    figure = new_figure(WIDTH, 2.0)
    all_axes = grid_of_axes(figure, len(_VELOCITIES), len(_VELOCITIES), sharex=True)
    for velocity, (axes, title) in enumerate(zip(all_axes, _VELOCITIES, strict=True)):
        axes.set_title(title)
        for model, color in _COLORS.items():
            errors = aligned([_MILLI * model_error(record, model, velocity) for record in run.episodes] for run in runs)
            draw_band(axes, range(1, errors.shape[1] + 1), errors, color)
        axes.set_ylim(bottom=0.0)
        axes.xaxis.set_major_locator(episode_locator())
    for line, (model, color) in enumerate(reversed(_COLORS.items())):
        place = (0.03, 0.06 + 0.1 * line)
        all_axes[0].text(*place, model, transform=all_axes[0].transAxes, color=color, fontsize=7, weight="bold")
    figure.supxlabel("episodes", fontsize=7.5, color=MUTED)
    caption = (
        "Root mean square error of the velocities that the model predicts a tick (0.2 s) ahead, of all ticks of an "
        "episode that it describes: median over runs and the band between the quartiles. The learned model predicts "
        "each tick with what the ticks before have taught it. What is left is noise of the sensors, where there is "
        "any, and what no coefficient can express, such as a body that rocks between its casters."
    )
    yield Picture("model_errors", "What the model gets wrong", caption + under(results, condition), figure)
