"""Tables of single actions, condition by condition, and of the controller's model beside the truth."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict

from mala_drake.control.parameters import DynamicsParameters
from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.messages import Outcome
from mala_drake.reporting.dynamics_truth import true_range, truths
from mala_drake.reporting.inner_loop_findings import thousandths
from mala_drake.reporting.inner_loop_results import (
    BAND,
    COEFFICIENTS,
    coefficient_course,
    has_actions,
    learning_condition,
    mean,
    mean_size,
    under,
    values_of,
)
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.result_tables import NONE, number
from mala_drake.reporting.results import Results, Run
from mala_drake.reporting.table import Group, Row, Table
from mala_drake.reporting.wording import words


def action_table(results: Results) -> Table | None:
    """What the actions of each condition came to; None where nothing tells."""
    rows = [_action_row(results, condition) for condition in results.conditions if has_actions(results, condition)]
    if not rows:
        return None
    headings = (
        "condition",
        "actions",
        "ended badly",
        "R^e an episode",
        "R^o a drive",
        "E^C early",
        "E^C late",
        "E^ψ early",
        "E^ψ late",
    )
    caption = (
        "Executed actions, and how many did not end as they should. R^e: minus the features by the weights planned "
        "with, summed over an episode; R^o: what the controller's own cost of a drive came to, in other units, which "
        "move with its weights where those are learned; both means over a run. E^C (its size, in thousandths) and "
        "E^ψ: means over the actions of an episode, over the first (early) and the second half (late) of a run. All "
        "are medians over runs."
    )
    return Table("actions", caption, headings, (Group(tuple(rows)),))


def _action_row(results: Results, condition: str) -> Row:
    runs = results.of(condition)
    entries = [entry for run in runs for record in run.episodes for entry in record.executed_actions or ()]
    halves = [(len(run.episodes) + 1) // 2 for run in runs]
    early = [run.episodes[:half] for run, half in zip(runs, halves, strict=True)]
    late = [run.episodes[half:] for run, half in zip(runs, halves, strict=True)]
    everything = [run.episodes for run in runs]
    costs = (_median(half, lambda record: mean_size(record, "cost_mismatch")) for half in (early, late))
    states = (_median(half, lambda record: mean_size(record, "state_mismatch")) for half in (early, late))
    return (
        words(results.learner(condition)),
        str(len(entries)),
        str(sum(entry.get("outcome") != Outcome.SUCCESS.value for entry in entries)),
        number(_median(everything, _reward), 3),
        number(_median(everything, lambda record: mean(values_of(record, "closed_loop_cost"))), 1),
        *(NONE if math.isnan(cost) else thousandths(cost) for cost in costs),
        *(number(state, 4) for state in states),
    )


def _median(runs: Iterable[Sequence[EpisodeRecord]], figure: Callable[[EpisodeRecord], float]) -> float:
    """The median over runs of the mean over their episodes."""
    return quantile((mean([figure(record) for record in episodes]) for episodes in runs), 0.5)


def _reward(record: EpisodeRecord) -> float:
    return math.fsum(values_of(record, "external_reward")) if record.executed_actions else math.nan


def dynamics_table(results: Results) -> Table | None:
    """Each coefficient of the controller's model at the end, beside the truth; None where none is learned."""
    condition = learning_condition(results, "learned_dynamics")
    if condition is None:
        return None
    runs, truth, nominal = results.of(condition), truths(results, condition), asdict(DynamicsParameters())
    rows = [_coefficient_row(runs, name, nominal[name], true_range(truth, name)) for name in COEFFICIENTS]
    headings = ("coefficient", "nominal", "true", "learned", "± 95 %", "off by", "true in band")
    caption = (
        "The controller's model after the last episode: medians over runs of each coefficient and of half its 95 % "
        "band. True: of the simulated robot, from when it carries nothing to when it carries two boxes, by its masses, "
        "inertias and wheels alone; the last columns say how far the median is from that range, and in how many runs "
        "the band meets it. The band knows of the noise that was seen and not of what no coefficient can express: "
        "casters that drag, a body that rocks between them."
    )
    return Table("dynamics", caption + under(results, condition), headings, (Group(tuple(rows)),))


def _coefficient_row(runs: Sequence[Run], name: str, nominal: float, true: tuple[float, float] | None) -> Row:
    finals = [list(coefficient_course(run, name, nominal))[-1] for run in runs]
    learned, reach = (quantile(column, 0.5) for column in zip(*finals, strict=True))
    row = (COEFFICIENTS[name], f"{nominal:g}")
    if true is None:
        return (*row, NONE, number(learned, 3), number(BAND * reach, 3), NONE, NONE)
    least, greatest = true
    off = max(least - learned, learned - greatest, 0.0) / abs(least if learned < least else greatest)
    met = sum(v - BAND * d <= greatest and v + BAND * d >= least for v, d in finals)
    return (
        *row,
        f"{least:.3f}–{greatest:.3f}",
        number(learned, 3),
        number(BAND * reach, 3),
        f"{100.0 * off:.1f} %",
        f"{met}/{len(finals)}",
    )
