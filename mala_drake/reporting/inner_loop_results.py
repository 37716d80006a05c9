"""What became of single actions, and what the controller learned from them, by episode."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.reporting.results import Results, Run
from mala_drake.reporting.wording import words

APPROACH, DRIVE, WORK = "drives to the bedside", "other drives", "work in place"
KINDS = (APPROACH, DRIVE, WORK)
"""Of actions."""

VELOCITIES = 3
"""That the controller's model predicts: forward, sideways, turning."""

COEFFICIENTS: Mapping[str, str] = MappingProxyType(
    {
        "yaw_coupling": "Yaw coupling c, 1/m",
        "propulsion_gain": "Propulsion gain",
        "brake_gain": "Brake gain",
        "yaw_gain": "Yaw gain",
        "lateral_damping": "Lateral damping k, 1/s",
        "lateral_coupling": "Lateral coupling g",
    }
)
"""Of the controller's model and what they are called, those first that have a truth of their own."""

BAND = 1.96
"""To each side of a 95 % interval of a normal distribution."""


def kind_of(action: str) -> str:
    """The kind of an action such as `(go_to_supply_a robot1 home)`."""
    name = action.strip("()")
    return APPROACH if name.startswith("approach_") else DRIVE if name.startswith("go_to_") else WORK


def values_of(record: EpisodeRecord, figure: str, kind: str | None = None) -> list[float]:
    """A figure of each executed action of an episode, those of one kind if it is given, where it is known."""
    entries = (entry for entry in record.executed_actions or () if kind in (None, kind_of(str(entry["action"]))))
    return [value for entry in entries if math.isfinite(value := _number(entry, figure))]


def mean_size(record: EpisodeRecord, figure: str, kind: str | None = None) -> float:
    """The mean of |figure| over the actions of an episode; NaN where there is none."""
    return mean(abs(value) for value in values_of(record, figure, kind))


def mean(values: Iterable[float]) -> float:
    """The mean, with NaN left out; NaN of nothing."""
    numbers = [value for value in values if not math.isnan(value)]
    return math.fsum(numbers) / len(numbers) if numbers else math.nan


def has_actions(results: Results, condition: str) -> bool:
    """Whether a condition tells of single actions; earlier versions did not."""
    return any(record.executed_actions for run in results.of(condition) for record in run.episodes)


def learning_condition(results: Results, learned: str) -> str | None:
    """The first condition that has something in a field of records, the main one before others; None if none has."""
    for condition in results.conditions:
        if any(getattr(record, learned) for run in results.of(condition) for record in run.episodes):
            return condition
    return None


def under(results: Results, condition: str) -> str:
    """Says under which condition something was learned, if not under the main one."""
    return "" if condition == results.main else f" Learned under {words(condition)}."


def coefficient_course(run: Run, name: str, nominal: float) -> Iterator[tuple[float, float]]:
    """A coefficient of the controller's model and its standard deviation: before the first episode and after each.

    Args:
        run: with learned dynamics; where an episode tells nothing, nothing has changed.
        name: of the coefficient.
        nominal: before anything is learned, with a deviation that nothing tells, NaN.
    """
    pair = (nominal, math.nan)
    yield pair
    for record in run.episodes:
        if record.learned_dynamics and name in record.learned_dynamics:
            value, deviation = record.learned_dynamics[name]
            pair = (float(value), float(deviation))
        yield pair


def model_error(record: EpisodeRecord, model: str, velocity: int) -> float:
    """The error of a velocity a tick ahead, by the `learned` or the `nominal` model; NaN if unknown."""
    errors = (record.dynamics_errors or {}).get(model)
    return float(errors[velocity]) if errors else math.nan


def error_ratios(run: Run) -> tuple[float, ...]:
    """The error a tick ahead of the learned model over that of the nominal one, by velocity, in the last episode.

    Empty where it is not known.
    """
    errors = [(model_error(run.final, "learned", i), model_error(run.final, "nominal", i)) for i in range(VELOCITIES)]
    return tuple(learned / nominal for learned, nominal in errors) if all(n > 0.0 for _, n in errors) else ()


def factor_course(run: Run, place: str, group: int) -> list[float]:
    """A factor of the weights of legs to a place: 1 before the first episode, and after each."""
    course = [1.0]
    for record in run.episodes:
        factors = (record.learned_weights or {}).get(place)
        course.append(float(factors[group]) if factors else course[-1])
    return course


def factor_places(results: Results, condition: str) -> tuple[str, ...]:
    """The places that factors were learned of, those of most runs first."""
    counts: dict[str, int] = {}
    for run in results.of(condition):
        for place in {place for record in run.episodes for place in record.learned_weights or ()}:
            counts[place] = counts.get(place, 0) + 1
    return tuple(sorted(counts, key=lambda place: (-counts[place], place)))


def gain_course(run: Run, row: int, column: int, start: float) -> list[float]:
    """By how much a gain of the translation has moved: 0 before the first episode, and after each."""
    course = [0.0]
    for record in run.episodes:
        gains = record.learned_translation
        course.append(float(gains[row][column]) - start if gains else course[-1])
    return course


def _number(entry: dict[str, Any], figure: str) -> float:
    value = entry.get(figure)
    return float(value) if isinstance(value, (int, float)) else math.nan
