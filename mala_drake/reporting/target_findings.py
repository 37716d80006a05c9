"""What a report says in words about displaced targets, all of it from the data."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mala_drake.reporting.findings import Figure
from mala_drake.reporting.paper_results import PAPER_TARGET_UPDATES
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.result_tables import number
from mala_drake.reporting.results import Results
from mala_drake.reporting.target_results import TargetRun, target_runs
from mala_drake.reporting.wording import words
from mala_drake.ward.ward_map import Ward


def target_headline(results: Results, ward: Ward) -> tuple[Figure, ...]:
    """The few figures that matter about the targets of the main condition."""
    runs = target_runs(results, ward, results.main)
    if not runs:
        return ()
    found = sum(run.updates_until_gone is not None for run in runs)
    return (
        Figure(f"{found}/{len(runs)}", "displaced places found", found == len(runs)),
        Figure(_count(_median_updates(runs)), "updates until then, median"),
        Figure(f"{number(_final(runs), 2)} m", "from target to true place at the end, median"),
    )


def target_sentences(results: Results, ward: Ward) -> tuple[str, ...]:
    """Condition by condition how places were found and whether tasks got done, beside the paper's figures."""
    sentences = []
    for condition in results.conditions:
        runs = target_runs(results, ward, condition)
        if not runs:
            continue
        records = [record for run in results.of(condition) for record in run.episodes]
        delivered = f"{sum(record.success for record in records)} of {len(records)} episodes delivered"
        off = f"targets end {number(_final(runs), 2)} m from the true places (median)"
        found = [count for run in runs if (count := run.updates_until_gone) is not None]
        told = f"{len(found)} of {len(runs)} places found"
        if found:
            median = _count(quantile(found, 0.5))
            told += f", after {median} update{'s' * (median != '1')} of the target (median; at most {max(found)})"
        sentences.append(f"{words(results.learner(condition)).capitalize()}: {told}; {off}; {delivered}.")
    first, last = min(PAPER_TARGET_UPDATES.values())[0], max(PAPER_TARGET_UPDATES.values())[1]
    sentences.append(
        f"In the paper targets came to rest after {first} to about {last} updates; how far from the true places, it "
        "does not say."
    )
    return tuple(sentences)


def _median_updates(runs: Sequence[TargetRun]) -> float:
    updates = [run.updates_until_gone for run in runs]
    return quantile((math.inf if count is None else float(count) for count in updates), 0.5)


def _final(runs: Sequence[TargetRun]) -> float:
    return quantile((run.distances[-1] for run in runs), 0.5)


def _count(value: float) -> str:
    return number(value, 1).removesuffix(".0")
