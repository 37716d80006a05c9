"""What an experiment came to, as its `summary.json` holds it: by condition and patient, and in all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
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
from mala_drake.learning.information_bound import efficiency
from mala_drake.preferences import CRITERIA
from mala_drake.reporting.bound_results import bounds_of
from mala_drake.reporting.profile_results import ProfileResults
from mala_drake.reporting.quantiles import Spread
from mala_drake.reporting.results import Run
from mala_drake.scenario import Scenario


def summarise_experiment(experiment: Experiment, folder: Path, failures: Mapping[RunName, str]) -> dict[str, Any]:
    """The figures of every run that has an episode, read from the files; all of it fit for JSON.

    `totals` and `profiles` are those of the first condition, which is what the experiment is about.

    Args:
        experiment: that was run.
        folder: of its results.
        failures: why runs have not come to their end.
    """
    runs = [run for name in experiment.runs if (run := _read(folder, name))]
    by_condition = {
        condition: _condition(experiment, [run for run in runs if run.condition == condition])
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


def _read(folder: Path, name: RunName) -> Run | None:
    records, _ = read_episodes(folder / name.folder / EPISODES_FILE)
    return Run(name.condition, name.profile, name.seed, tuple(records)) if records else None


def _condition(experiment: Experiment, runs: Sequence[Run]) -> dict[str, Any]:
    """Totals and figures by profile of the runs of one condition."""
    records = [record for run in runs for record in run.episodes]
    profiles = []
    for profile in experiment.profiles:
        of_profile = tuple(run for run in runs if run.profile == profile)
        if of_profile:
            scenario = experiment.scenario(RunName(of_profile[0].condition, profile, of_profile[0].seed))
            profiles.append(
                (ProfileResults(scenario.profile_name, profile, of_profile, scenario.true_weights), scenario)
            )
    totals = {
        "runs": len(runs),
        "converged": sum(figures.converged for figures, _ in profiles),
        "dominant_right": sum(figures.dominant_right or 0 for figures, _ in profiles),
        "error_over_bound": _error_over_bound(
            [(run, scenario) for figures, scenario in profiles for run in figures.runs]
        ),
        "prediction_error": _prediction_error(records),
        **totals_of(records),
    }
    by_profile = {figures.profile: _profile(figures) for figures, _ in profiles}
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


def _error_over_bound(runs: Sequence[tuple[Run, Scenario]]) -> float | None:
    """Root mean square, over runs and weights, of final error over the least standard deviation that was possible.

    It is for the features that were really seen, with the simplex constraint. None where there is no such bound: of
    ratings without noise, or when too little was rated in some run.
    """
    runs = [(_since_change_of_mind(run, scenario), scenario) for run, scenario in runs]
    if not runs or any(scenario.patient.noise == 0.0 or not run.episodes for run, scenario in runs):
        return None
    errors = [np.subtract(run.final.weights_after, scenario.true_weights) for run, scenario in runs]
    bounds = [bounds_of(run, scenario.patient.noise)[-1] for run, scenario in runs]
    return efficiency(errors, bounds) if np.isfinite(bounds).all() else None


def _since_change_of_mind(run: Run, scenario: Scenario) -> Run:
    """The run without the episodes that tell nothing about what the patient wants in the end."""
    return replace(run, episodes=run.episodes[scenario.patient.earlier_episodes :])
