"""Errors of the learned weights in units of what could be known: the information bound of the episodes really rated."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mala_drake.learning.information_bound import efficiency, weight_bound
from mala_drake.preferences import CRITERIA
from mala_drake.reporting.results import Results, Run


def rating_noise(results: Results, condition: str) -> float | None:
    """The standard deviation of a rating, as the folder tells it; None where it does not, or there is no noise."""
    noise = results.told(condition, "patient", "noise")
    usable = isinstance(noise, (int, float)) and math.isfinite(noise) and noise > 0
    return float(noise) if usable and noise is not None else None


def bounds_of(run: Run, noise: float) -> NDArray[np.float64]:
    """The bound of each weight after each episode, shape (episodes, 5), from the features that had been rated by then.

    Infinite for weights that they do not tell yet. What was rated before a change of mind tells of none.
    """
    rated = np.array(
        [
            [
                math.nan if rating is None else record.features[criterion]
                for criterion, rating in zip(CRITERIA, record.ratings or [None] * len(CRITERIA), strict=True)
            ]
            for record in run.episodes
        ]
    )
    rated[: run.earlier_episodes] = math.nan
    return np.array([weight_bound(rated[: n + 1], noise) for n in range(len(rated))])


def errors_of(run: Run, true_weights: Sequence[float]) -> NDArray[np.float64]:
    """Learned minus true weights after each episode, shape (episodes, 5)."""
    return np.array([record.weights_after for record in run.episodes]) - np.asarray(true_weights, dtype=float)


def known_runs(results: Results, condition: str) -> list[tuple[Run, tuple[float, ...]]]:
    """The runs of a condition whose patients' wishes are known, with these."""
    return [(run, true) for run in results.of(condition) if (true := results.true_weights(run.profile)) is not None]


def final_error_over_bound(runs: Sequence[tuple[Run, Sequence[float]]], noise: float | None) -> float | None:
    """Root mean square, over runs and weights, of error over bound after the last episode of each run.

    None where there is no such bound: of no runs, of ratings without noise, or when too little was rated in some run.

    Args:
        runs: with the true weights of their patients.
        noise: standard deviation of a rating; None and 0 are none.
    """
    if not runs or not noise:
        return None
    bounds = [bounds_of(run, noise)[-1] for run, _ in runs]
    errors = [errors_of(run, true)[-1] for run, true in runs]
    return efficiency(errors, bounds) if np.isfinite(bounds).all() else None


def error_over_bound(results: Results, condition: str) -> NDArray[np.float64]:
    """Root mean square of error over bound after each episode, over runs and weights; NaN before the bound is finite.

    Only episodes that all runs have count, and only patients whose wishes are known. Empty where there is no bound.
    """
    noise = rating_noise(results, condition)
    known = known_runs(results, condition)
    if noise is None or not known:
        return np.empty(0)
    length = min(len(run.episodes) for run, _ in known)
    bounds = np.array([bounds_of(run, noise)[:length] for run, _ in known])
    errors = np.array([errors_of(run, true)[:length] for run, true in known])
    return np.array(
        [
            efficiency(list(errors[:, n]), list(bounds[:, n])) if np.isfinite(bounds[:, n]).all() else math.nan
            for n in range(length)
        ]
    )
