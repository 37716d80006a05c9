"""What an experiment came to, as its `summary.json` holds it: by condition and patient, and in all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import mala_drake
from mala_drake.experiments.episode_reader import read_episodes
from mala_drake.experiments.episode_record import EPISODES_FILE, EpisodeRecord, plain
from mala_drake.experiments.experiment import Experiment, RunName
from mala_drake.experiments.run_summary import timing_of, totals_of
from mala_drake.experiments.target_summary import target_figures
from mala_drake.fingerprint import fingerprint
from mala_drake.preferences import CRITERIA
from mala_drake.reporting.bound_results import final_error_over_bound
from mala_drake.reporting.profile_results import ProfileResults
from mala_drake.reporting.quantiles import Spread
from mala_drake.reporting.results import Run


def summarise_experiment(experiment: Experiment, folder: Path, failures: Mapping[RunName, str]) -> dict[str, Any]:
    """The figures of every run that has an episode, read from the files; all of it fit for JSON.

    `totals` and `profiles` are those of the first condition, which is what the experiment is about.

    Args:
        experiment: that was run.
        folder: of its results.
        failures: why runs have not come to their end.
    """
    runs = [run for name in experiment.runs if (run := _read(experiment, folder, name))]
    by_condition = {
        condition: _condition(experiment, condition, [run for run in runs if run.condition == condition])
        for condition in experiment.conditions
    }
    main = next(iter(experiment.conditions))
    scenario = experiment.scenario(RunName(main, experiment.profiles[0], experiment.seeds[0]))
    summary: dict[str, Any] = plain(
        {
            "version": mala_drake.__version__,
            "fingerprint": fingerprint(scenario.ward),
            "experiment": experiment.name,
            "scenario": asdict(scenario) | {"patient": asdict(experiment.base.patient)},
            "seed": list(experiment.seeds),
            "condition": main,
            **by_condition[main],
            "conditions": {name: figures for name, figures in by_condition.items() if name},
            "unfinished": {str(run): error for run, error in failures.items()},
            "timing": timing_of([record for run in runs for record in run.episodes]),
        }
    )
    return summary


def _read(experiment: Experiment, folder: Path, name: RunName) -> Run | None:
    records, _ = read_episodes(folder / name.folder / EPISODES_FILE)
    earlier = experiment.scenario(name).patient.earlier_episodes
    return Run(name.condition, name.profile, name.seed, tuple(records), earlier) if records else None


def _condition(experiment: Experiment, condition: str, runs: Sequence[Run]) -> dict[str, Any]:
    """Totals and figures by profile of the runs of one condition."""
    records = [record for run in runs for record in run.episodes]
    scenarios = {
        profile: experiment.scenario(RunName(condition, profile, experiment.seeds[0]))
        for profile in experiment.profiles
    }
    profiles = [
        ProfileResults(condition, profile, of_profile, scenario.true_weights)
        for profile, scenario in scenarios.items()
        if (of_profile := tuple(run for run in runs if run.profile == profile))
    ]
    known = [(run, scenarios[run.profile].true_weights) for figures in profiles for run in figures.runs]
    noise = scenarios[experiment.profiles[0]].patient.noise
    right = [figures.dominant_right for figures in profiles if figures.dominant_right is not None]
    totals = {
        "runs": len(runs),
        "converged": sum(figures.converged for figures in profiles),
        "dominant_right": sum(right) if right or not profiles else None,
        "error_over_bound": final_error_over_bound(known, noise),
        "prediction_error": _prediction_error(records),
        **totals_of(records),
    }
    by_profile = {figures.profile: _profile(figures) for figures in profiles}
    targets = target_figures([run.episodes for run in runs])
    return {"totals": totals, "profiles": by_profile, **({"targets": targets} if targets else {})}


def _profile(figures: ProfileResults) -> dict[str, Any]:
    """The figures of one patient: medians over the runs, quartiles beside them."""
    variants = figures.variants()
    return {
        **_spread("convergence_episode", figures.convergence),
        **_spread("best_distance", figures.best_distance),
        **_spread("final_distance", figures.final_distance),
        "success_rate": figures.successes / figures.episodes,
        "plan_variants": sorted(variants),
        "plan_variant_counts": {variant: variants[variant] for variant in sorted(variants)},
        "runs": len(figures.runs),
        "converged": figures.converged,
        "dominant_right": figures.dominant_right,
        "episodes": figures.episodes,
        "successes": figures.successes,
        "collisions": figures.collisions,
    }


def _spread(name: str, figures: Spread) -> dict[str, Any]:
    """A median and its quartiles; null where it is infinite, as for a run that never converged."""
    return {name: figures.median, f"{name}_quartiles": [figures.lower, figures.upper]}


def _prediction_error(records: Sequence[EpisodeRecord]) -> dict[str, float | None]:
    """By criterion, how far the planner's prediction was off in an average delivered episode."""
    delivered = [record for record in records if record.success]
    return {
        criterion: float(
            np.mean([abs(record.predicted_features[criterion] - record.features[criterion]) for record in delivered])
        )
        if delivered
        else None
        for criterion in CRITERIA
    }
