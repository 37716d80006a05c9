"""How well the patient's wishes were learned in one run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.learning.convergence import convergence_episode


@dataclass(frozen=True, slots=True)
class LearningFigures:
    """Of the episodes since the patient's change of mind; of all where there was none.

    Attributes:
        convergence_episode: the number of rated episodes after which the run had converged, None for never.
        best_distance: the least distance to the true weights after an episode; NaN of no episode.
        final_distance: the distance after the last episode; NaN of no episode.
    """

    convergence_episode: int | None
    best_distance: float
    final_distance: float


def learning_figures(records: Sequence[EpisodeRecord], *, earlier_episodes: int) -> LearningFigures:
    """The figures of a run.

    Args:
        records: of its episodes, in their order.
        earlier_episodes: how many of them came before a change of mind: they tell how well other wishes were known.
    """
    since = records[earlier_episodes:]
    return LearningFigures(
        convergence_episode=convergence_episode(record.distance_to_true for record in since if record.rated),
        best_distance=min((record.distance_to_true for record in since), default=math.nan),
        final_distance=since[-1].distance_to_true if since else math.nan,
    )
