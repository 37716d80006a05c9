"""`mala-drake experiment NAME`: from what is asked for to results on disk."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mala_drake.errors import BadInput
from mala_drake.experiments.ablations import ABLATION_KIND
from mala_drake.experiments.compute_episode import compute_episode
from mala_drake.experiments.condition_page import page_of, write_condition_page
from mala_drake.experiments.conduct import ExperimentWatcher, conduct
from mala_drake.experiments.convergence import CONVERGENCE
from mala_drake.experiments.durable_files import replace_durably
from mala_drake.experiments.executors import make_executor
from mala_drake.experiments.experiment_folder import begun_in, experiment_folder
from mala_drake.experiments.experiment_kind import ExperimentKind, ExperimentOptions, chosen_experiment
from mala_drake.experiments.experiment_summary import summarise_experiment
from mala_drake.experiments.run_summary import SUMMARY_FILE
from mala_drake.experiments.targets import TARGETS

EXPERIMENTS = {kind.name: kind for kind in (CONVERGENCE, ABLATION_KIND, TARGETS)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Execution:
    """How an experiment is carried out: nothing that its results depend on.

    Attributes:
        out: folder of the results.
        resume: whether to go on with what is there; where there is nothing, the experiment begins anew.
        overwrite: whether to replace what is there.
        executor: where episodes are computed.
        jobs: how many at a time; None for what there is room for.
        address: of the executor's scheduler, where it has one.
    """

    out: Path
    resume: bool = False
    overwrite: bool = False
    executor: str = "processes"
    jobs: int | None = None
    address: str | None = None


def experiment_kind(name: str) -> ExperimentKind:
    """The kind of experiment called `name`.

    Raises:
        BadInput: there is none.
    """
    if name not in EXPERIMENTS:
        raise BadInput("experiment", repr(name), "one of " + ", ".join(EXPERIMENTS))
    return EXPERIMENTS[name]


def run_experiment(
    kind: ExperimentKind, options: ExperimentOptions, execution: Execution, *, watcher: ExperimentWatcher
) -> dict[str, Any]:
    """Runs an experiment, or the rest of one, and returns the summary that `summary.json` holds.

    Raises:
        BadInput: when an option does not fit, or the folder cannot be used; nothing has been changed there then. Later
            only when what is written does not fit on the disk any more.
    """
    begun = begun_in(execution.out) if execution.resume else None
    if begun is not None and begun.name != kind.name:
        raise BadInput("experiment", kind.name, f"{begun.name}, which was begun in {execution.out}")
    experiment = chosen_experiment(kind, options, begun=begun)
    with (
        make_executor(execution.executor, compute_episode, jobs=execution.jobs, address=execution.address) as executor,
        experiment_folder(execution.out, experiment, resume=execution.resume, overwrite=execution.overwrite),
    ):
        if execution.resume and begun is None:
            watcher.on_nothing_begun(execution.out)
        failures = conduct(experiment, execution.out, executor, watcher=watcher)
        summary = summarise_experiment(experiment, execution.out, failures)
        replace_durably(execution.out / SUMMARY_FILE, json.dumps(summary, indent=2, allow_nan=False) + "\n")
        if kind.explanations is not None and summary["totals"]["episodes"]:
            write_condition_page(execution.out, experiment, kind.explanations)
    return summary


def files_of(kind: ExperimentKind, folder: Path) -> list[Path]:
    """What there is in the folder besides the runs."""
    return [path for path in (folder / SUMMARY_FILE, page_of(folder, kind.name)) if path.exists()]
