"""The controller's model as it was learned: each coefficient by episode, with its band and the truth."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mala_drake.control.parameters import DynamicsParameters
from mala_drake.reporting.dynamics_truth import true_range, truths
from mala_drake.reporting.figures.curves import aligned, episode_locator
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import BUSY, CRITERION_COLORS, MUTED, WIDTH, grid_of_axes, new_figure
from mala_drake.reporting.inner_loop_results import BAND, COEFFICIENTS, coefficient_course, learning_condition, under
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.results import Results, Run
from mala_drake.robot.true_dynamics import TrueDynamics

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOR = CRITERION_COLORS["time"]


def dynamics_picture(results: Results) -> Iterator[Picture]:
    """A panel a coefficient."""
    condition = learning_condition(results, "learned_dynamics")
    if condition is None:
        return
    runs, truth = results.of(condition), truths(results, condition)
    nominal = asdict(DynamicsParameters())
    figure = new_figure(WIDTH, 3.9)
    all_axes = grid_of_axes(figure, len(COEFFICIENTS), 3, sharex=True)
    medians = {}
    for axes, (name, title) in zip(all_axes, COEFFICIENTS.items(), strict=True):
        axes.set_title(title)
        medians[name] = _draw(axes, runs, name, nominal[name])
        axes.axhline(nominal[name], color=MUTED, linewidth=0.8, dashes=(1.5, 2.5))
        _draw_truth(axes, truth, name)
        axes.xaxis.set_major_locator(episode_locator())
    all_axes[0].set_xlim(0, max(len(run.episodes) for run in runs))
    _name_lines(all_axes[0], truth, nominal["yaw_coupling"])
    _draw_slip(all_axes[-1], truth, medians["lateral_damping"])
    figure.supxlabel("episodes", fontsize=7.5, color=MUTED)
    yield Picture("dynamics", "The controller's model, as it was learned", _caption(results, condition, truth), figure)


def _draw(axes: Axes, runs: tuple[Run, ...], name: str, nominal: float) -> NDArray[np.float64]:
    """Draws a coefficient; returns its medians."""
    courses = [list(zip(*coefficient_course(run, name, nominal), strict=True)) for run in runs]
    values, deviations = (aligned(course[part] for course in courses) for part in range(2))
    middle = np.array([quantile(column, 0.5) for column in values.T])
    reach = BAND * np.array([quantile(column, 0.5) for column in deviations.T])
    x = range(middle.size)
    axes.fill_between(x, middle - reach, middle + reach, color=_COLOR, alpha=0.2, linewidth=0)
    if len(runs) > 1:
        axes.plot(values.T, color=_COLOR, linewidth=0.6, alpha=0.6)
    axes.plot(x, middle, color=_COLOR, marker="o", markersize=2.5)
    return middle


def _draw_truth(axes: Axes, truth: tuple[TrueDynamics, ...], name: str) -> None:
    span = true_range(truth, name)
    if span is None:
        return
    axes.axhspan(*span, color=BUSY, alpha=0.2, linewidth=0)
    axes.axhline(getattr(truth[0], name), color=BUSY, linewidth=1.0, dashes=(4, 3))


def _name_lines(axes: Axes, truth: tuple[TrueDynamics, ...], nominal: float) -> None:
    """Says in the panel of the yaw coupling, which has room for it, what the lines are."""
    lines = [(nominal, "nominal", MUTED, 2)]
    if truth:
        lines.append((truth[0].yaw_coupling, "true", BUSY, -9))
    for y, text, color, shift in lines:
        place = (axes.get_xlim()[1], y)
        axes.annotate(
            text, place, (-2, shift), textcoords="offset points", ha="right", color=color, fontsize=6.5, weight="bold"
        )


def _draw_slip(axes: Axes, truth: tuple[TrueDynamics, ...], damping: NDArray[np.float64]) -> None:
    """What g has to be beside the learned k, as only g/k is anything real."""
    if truth:
        axes.plot(truth[0].lateral_slip * damping, color=BUSY, linewidth=1.0, dashes=(4, 3))


def _caption(results: Results, condition: str, truth: tuple[TrueDynamics, ...]) -> str:
    text = (
        "Coefficients of the controller's model after each episode: median over runs"
        f"{'' if len(results.of(condition)) == 1 else ' (thin: each run)'}, in the learner's own 95 % band (the median "
        "of its width). Dotted: nominal, as before the first episode."
    )
    if truth:
        text += (
            " Dashed: the truth of the simulated robot, from its masses, inertias and wheels, when it carries nothing; "
            "shaded up to when it carries two boxes, as the learner has one model for all loads. Lateral damping and "
            "coupling have no truth of their own, since wheels hardly slip: only their ratio can be seen, and what g "
            "should be beside the learned k is dashed."
        )
    return text + under(results, condition)
