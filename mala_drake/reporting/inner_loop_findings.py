"""What a report says in words of single actions, and of what the controller learned from them."""

from __future__ import annotations

from collections.abc import Iterator

from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION
from mala_drake.learning.weight_estimator import WEIGHT_GROUPS
from mala_drake.reporting.inner_loop_results import (
    error_ratios,
    factor_places,
    has_actions,
    learning_condition,
    mean_size,
    values_of,
)
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.results import Results
from mala_drake.reporting.wording import title_of, words


def inner_loop_sentences(results: Results) -> tuple[str, ...]:
    """What actions came to beside what was expected of them, and what the controller learned."""
    return (*_actions(results), *_dynamics(results), *_weights(results), *_translation(results))


def _actions(results: Results) -> Iterator[str]:
    if not has_actions(results, results.main):
        return
    yield (
        "Every executed action is judged by its reward R^e, minus its features by the weights that the episode was "
        "planned with (what the robot believes of the patient, not the patient's own rating), by R^o, what a "
        "drive cost the controller, and by how far cost and state were from what was expected, E^C and E^ψ."
    )
    runs = results.of(results.main)
    for task in results.tasks:
        told = [episodes for run in runs if (episodes := [r for r in run.of_task(task) if r.executed_actions])]
        if told:
            first, last = (quantile((mean_size(each[i], "cost_mismatch") for each in told), 0.5) for i in (0, -1))
            yield (
                f"{title_of(task)}: on average an action cost {thousandths(first)} thousandths more or less than "
                f"predicted in the first episode and {thousandths(last)} in the last (medians over runs)."
            )
    states = [value for run in runs for record in run.episodes for value in values_of(record, "state_mismatch")]
    yield f"After {sum(value == 0.0 for value in states)} of {len(states)} actions E^ψ was 0: all was as expected."


def _dynamics(results: Results) -> Iterator[str]:
    condition = learning_condition(results, "dynamics_errors")
    if condition is None:
        return
    ratios = [found for run in results.of(condition) if (found := error_ratios(run))]
    if ratios:
        forward, sideways, turning = (f"{quantile(column, 0.5):.2f}" for column in zip(*ratios, strict=True))
        yield (
            f"{_start(results, condition)}A tick ahead, the learned model's errors are {forward} (forward), {sideways} "
            f"(sideways) and {turning} (turning) times those of the nominal model in the last episode (medians)."
        )


def _weights(results: Results) -> Iterator[str]:
    condition = learning_condition(results, "learned_weights")
    if condition is None:
        return
    found = [
        (max(factor, 1.0 / factor), factor, WEIGHT_GROUPS[i], place)
        for run in results.of(condition)
        for place, factors in (run.final.learned_weights or {}).items()
        for i, factor in enumerate(factors)
    ]
    if found:
        _, factor, group, place = max(found)
        places = len(factor_places(results, condition))
        yield (
            f"{_start(results, condition)}The controller's weights were learned for drives to {places} "
            f"place{'s' * (places != 1)}; farthest from 1 at the end is that of {group} for {words(place)}, at "
            f"{factor:.2f}."
        )


def _translation(results: Results) -> Iterator[str]:
    condition = learning_condition(results, "learned_translation")
    if condition is None:
        return
    starts = DEFAULT_TRANSLATION.gains
    moved = [
        abs(gain - starts[i, j])
        for run in results.of(condition)
        for i, row in enumerate(run.final.learned_translation or ())
        for j, gain in enumerate(row)
    ]
    if moved:
        yield (
            f"{_start(results, condition)}No gain from preferences to the controller's weights has moved by more than "
            f"{max(moved):.2g}."
        )


def _start(results: Results, condition: str) -> str:
    """Goes before a sentence on a condition."""
    return "" if condition == results.main else f"Under {words(condition)}: "


def thousandths(value: float) -> str:
    """A figure in thousandths, with two digits that mean something."""
    return f"{1000.0 * value:#.2g}".removesuffix(".")
