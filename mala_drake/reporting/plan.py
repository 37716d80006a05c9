"""What was to be run in a folder of results, and what of it is missing."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from mala_drake.errors import BadInput
from mala_drake.experiments.experiment import Experiment, RunName
from mala_drake.experiments.experiment_folder import EXPERIMENT_FILE
from mala_drake.experiments.run_summary import SUMMARY_FILE
from mala_drake.reporting.wording import words

_MOST_NAMED = 6  # Missing runs that are named one by one.


def read_plan(folder: Path, notes: list[str]) -> Experiment | None:
    """The experiment that was begun in a folder; None, with a note if there should be one, where none can be read."""
    path = folder / EXPERIMENT_FILE
    if not path.is_file():
        return None
    try:
        plan = Experiment.from_json(json.loads(path.read_bytes()), where=EXPERIMENT_FILE)
        plan.validate()
    except (OSError, ValueError, BadInput) as error:
        reason = str(error) if isinstance(error, BadInput) else "it is not JSON"
        notes.append(f"{EXPERIMENT_FILE} is of no use ({reason}), so nobody can tell whether runs are missing.")
        return None
    return plan


def scenarios_of(
    folder: Path, plan: Experiment | None, conditions: Sequence[str], notes: list[str]
) -> Mapping[str, Mapping[str, Any]]:
    """What was run under each condition: as planned, or as the summary of the folder or of a run tells it."""
    if not (folder / SUMMARY_FILE).is_file():
        notes.append(f"There is no {SUMMARY_FILE}: the runs may not have come to their end.")
    if plan is not None:
        return {name: _planned_scenario(plan, name) for name in plan.conditions}
    return dict.fromkeys(conditions, _told_scenario(folder))


def _planned_scenario(plan: Experiment, condition: str) -> Mapping[str, Any]:
    """The scenario of a condition, with the weights of the patient that is none of the paper's, if there is one."""
    scenario = plan.scenario(RunName(condition, plan.profiles[0], plan.seeds[0]))
    return asdict(scenario) | {"patient": asdict(scenario.patient) | {"true_weights": plan.base.patient.true_weights}}


def _told_scenario(folder: Path) -> Mapping[str, Any]:
    for candidate in (folder / SUMMARY_FILE, *sorted(folder.rglob(SUMMARY_FILE))):
        try:
            summary = json.loads(candidate.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            continue
        scenario = summary.get("scenario") if isinstance(summary, dict) else None
        if isinstance(scenario, dict):
            return scenario
    return {}


def missing_from_plan(plan: Experiment, lengths: Mapping[RunName, int]) -> Iterator[str]:
    """What is less than was planned.

    Args:
        plan: the experiment.
        lengths: how many episodes there are of each run that has any.
    """
    absent = [run for run in plan.runs if run not in lengths]
    if absent:
        yield f"{len(absent)} of {len(plan.runs)} runs have no episode yet: {_named(absent)}."
    short = [run for run in plan.runs if run in lengths and lengths[run] < plan.scenario(run).episodes]
    if short:
        yield f"{len(short)} of {len(plan.runs)} runs are not finished: {_named(short)}."


def missing_beside_others(lengths: Mapping[RunName, int]) -> Iterator[str]:
    """What is less than it should be, judged by the other runs of the same condition.

    Args:
        lengths: how many episodes there are of each run.
    """
    for condition in dict.fromkeys(run.condition for run in lengths):
        of_condition = [run for run in lengths if run.condition == condition]
        within = f" under {words(condition)}" if condition else ""
        seeds = {run.seed for run in of_condition}
        for profile in dict.fromkeys(run.profile for run in of_condition):
            absent = sorted(seeds - {run.seed for run in of_condition if run.profile == profile})
            if absent:
                numbers = ", ".join(map(str, absent))
                yield f"No run of {words(profile)} with seed {numbers}{within}, which other profiles have."
        longest = max(lengths[run] for run in of_condition)
        for run in of_condition:
            if lengths[run] < longest:
                done = f"{lengths[run]} of {longest} episodes"
                yield f"The run of {words(run.profile)}, seed {run.seed}{within}, has only {done}."


def _named(runs: Iterable[RunName]) -> str:
    names = [words(str(run)) for run in runs]
    more = len(names) - _MOST_NAMED
    return "; ".join(names[:_MOST_NAMED]) + (f"; and {more} more" if more > 0 else "")
