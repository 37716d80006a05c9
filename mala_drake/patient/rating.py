"""How a patient rates an episode: r_i = 5 - 4 f_i w*_i + epsilon_i (paper, Sec. "Patient Profiles")."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mala_drake.errors import BadInput
from mala_drake.preferences import CRITERIA

BEST_RATING = 5.0
WORST_RATING = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RatingHabits:
    """How precisely and how completely a patient rates.

    Attributes:
        noise: standard deviation of epsilon_i (the paper's N(0, 0.1), read as a standard deviation).
        clip: whether ratings are cut to [1, 5]. It biases ratings near 5, so the paper's formula does without.
        missing: probability that a criterion is left unrated.

    Raises:
        BadInput: if the noise is negative or not finite, or `missing` is not a probability.
    """

    noise: float = 0.1
    clip: bool = False
    missing: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.noise) and self.noise >= 0.0):
            raise BadInput("patient.noise", str(self.noise), "a finite standard deviation >= 0")
        if not 0.0 <= self.missing <= 1.0:
            raise BadInput("patient.missing", str(self.missing), "a probability in [0, 1]")


def expected_ratings(features: Sequence[float], weights: Sequence[float]) -> np.ndarray:
    """The ratings without noise, 5 - 4 f_i w_i: one number a criterion."""
    return BEST_RATING - (BEST_RATING - WORST_RATING) * np.asarray(features) * np.asarray(weights)


def rate(
    features: Sequence[float], weights: Sequence[float], generator: np.random.Generator, habits: RatingHabits
) -> tuple[float | None, ...]:
    """The ratings of one episode, None where the patient did not rate.

    Args:
        features: measured f in [0, 1], one a criterion, 0 best. One that is not finite cannot be rated.
        weights: the patient's true weights w*.
        generator: of this episode; every call draws the same number of samples, whatever the habits.
        habits: noise, clipping and missing ratings.
    """
    noise = generator.standard_normal(len(CRITERIA))
    left_out = generator.random(len(CRITERIA)) < habits.missing
    ratings = expected_ratings(features, weights) + habits.noise * noise
    if habits.clip:
        ratings = np.clip(ratings, WORST_RATING, BEST_RATING)
    return tuple(
        float(rating) if math.isfinite(rating) and not skipped else None
        for rating, skipped in zip(ratings, left_out, strict=True)
    )
