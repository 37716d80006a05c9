"""What came of one patient under one condition: the figures of the convergence table."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from mala_drake.preferences import CRITERIA
from mala_drake.reporting.quantiles import Spread, spread
from mala_drake.reporting.results import Results, Run


@dataclass(frozen=True)
class ProfileResults:
    """The runs of one patient under one condition, at least one, and what they came to.

    Attributes:
        condition: of the runs.
        profile: of the patient.
        runs: one a seed.
        true_weights: of the patient, None where they are not known.
    """

    condition: str
    profile: str
    runs: tuple[Run, ...]
    true_weights: tuple[float, ...] | None

    @property
    def convergence_episodes(self) -> tuple[int | None, ...]:
        """The number of rated episodes after which each run had converged, None for never."""
        return tuple(run.learning.convergence_episode for run in self.runs)

    @property
    def converged(self) -> int:
        """How many runs converged."""
        return sum(episode is not None for episode in self.convergence_episodes)

    @property
    def convergence(self) -> Spread:
        """Of the convergence episodes; a run that never converged counts as infinitely late."""
        return spread(math.inf if episode is None else float(episode) for episode in self.convergence_episodes)

    @property
    def best_distance(self) -> Spread:
        """Of the least distance in each run."""
        return spread(run.learning.best_distance for run in self.runs)

    @property
    def final_distance(self) -> Spread:
        """Of the distance after each run's last episode."""
        return spread(run.learning.final_distance for run in self.runs)

    @property
    def dominant_right(self) -> int | None:
        """How many runs end with the greatest weight on a criterion that matters most to the patient.

        None where nobody knows what does, and where everything matters alike.
        """
        if self.true_weights is None or len(wanted := dominant(self.true_weights)) == len(CRITERIA):
            return None
        return sum(dominant(run.final.weights_after) <= wanted for run in self.runs)

    @property
    def episodes(self) -> int:
        """Of all runs together."""
        return sum(len(run.episodes) for run in self.runs)

    @property
    def successes(self) -> int:
        """Episodes in which the task was done."""
        return sum(record.success for run in self.runs for record in run.episodes)

    @property
    def collisions(self) -> int:
        """Of all runs together."""
        return sum(record.collisions for run in self.runs for record in run.episodes)

    @property
    def cost(self) -> Spread:
        """Of what an average episode of each run cost the patient: w*·f, the true weights on the measured features.

        Only of episodes in which the task was done, since a change of mind; runs without any are left out.
        """
        true = self.true_weights
        if true is None:
            return spread(())
        done = [[record for record in run.episodes[run.earlier_episodes :] if record.success] for run in self.runs]
        return spread(
            sum(
                weight * record.features[criterion]
                for record in records
                for weight, criterion in zip(true, CRITERIA, strict=True)
            )
            / len(records)
            for records in done
            if records
        )

    def variants(self, task: str | None = None) -> Counter[str]:
        """How often each plan variant was executed to its end, of one task or of all.

        The names of variants of different tasks are different.
        """
        return Counter(
            record.plan_variant
            for run in self.runs
            for record in run.episodes
            if record.success and task in (None, record.task)
        )


def profile_results(results: Results, condition: str) -> tuple[ProfileResults, ...]:
    """The figures of each profile that was run under a condition."""
    profiles = dict.fromkeys(run.profile for run in results.of(condition))
    return tuple(
        ProfileResults(condition, profile, results.of(condition, profile), results.true_weights(profile))
        for profile in profiles
    )


def dominant(weights: Sequence[float]) -> frozenset[str]:
    """The criteria of the greatest weight: one, or several where weights are equal."""
    greatest = max(weights)
    return frozenset(criterion for criterion, weight in zip(CRITERIA, weights, strict=True) if weight == greatest)
