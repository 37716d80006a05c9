"""The contract of everything that learns preference weights from ratings."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from mala_drake.learning.abstract_learner import AbstractLearner, FloatArray

__all__ = ["AbstractPreferenceLearner", "FloatArray", "rated"]


class AbstractPreferenceLearner(AbstractLearner):
    """Turns ratings into preference weights.

    A learner object holds its settings and never changes; what it has learned is one vector of numbers, its state,
    which the caller keeps: in the discrete state of a system, in a checkpoint, or in a local variable.

        learner = ProjectedGradient()
        state = learner.initial_state()
        state = learner.update(state, ratings=report.ratings, features=report.features)
        weights = learner.estimate(state)
    """

    __slots__ = ()

    @abstractmethod
    def update(self, state: FloatArray, *, ratings: Sequence[float | None], features: Sequence[float]) -> FloatArray:
        """The state after one rated episode.

        Args:
            state: before; not modified.
            ratings: one a criterion, None where the patient did not rate. An episode in which no criterion has both
                a rating and a finite feature leaves the state as it is.
            features: measured f in [0, 1], one a criterion.
        """

    @abstractmethod
    def updates(self, state: FloatArray) -> int:
        """How many rated episodes the state has learned from."""

    @abstractmethod
    def estimate(self, state: FloatArray) -> FloatArray:
        """The learner's own weights: (5,), on the simplex."""

    @abstractmethod
    def deviation(self, state: FloatArray) -> FloatArray | None:
        """The standard deviation of each weight, (5,), or None for a point estimate."""

    def interval(self, state: FloatArray, probability: float = 0.9) -> FloatArray | None:  # noqa: ARG002
        """The credible interval of each weight, lower and upper ends (5, 2), or None for a point estimate."""
        return None

    @abstractmethod
    def planning_weights(self, state: FloatArray, generator: np.random.Generator) -> FloatArray:
        """Weights to plan the next episode with, explored by drawing from `generator`: (5,), on the simplex."""


def rated(ratings: Sequence[float | None], features: Sequence[float]) -> tuple[FloatArray, FloatArray, npt.NDArray]:
    """Ratings, features and the mask of the criteria that can be learned from; zeros where they cannot.

    A criterion counts when it has a finite rating and a finite feature. An empty `ratings` means that none was rated.

    Returns:
        Three arrays (5,): ratings, features, and the mask (bool).
    """
    given = [np.nan if rating is None else rating for rating in ratings] or [np.nan] * len(features)
    rating_array = np.array(given, dtype=float)
    feature_array = np.array(features, dtype=float)
    mask = np.isfinite(rating_array) & np.isfinite(feature_array)
    return np.where(mask, rating_array, 0.0), np.where(mask, feature_array, 0.0), mask
