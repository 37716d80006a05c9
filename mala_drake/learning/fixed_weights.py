"""The learner that does not learn: fixed weights, the baseline of every comparison."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mala_drake.learning.abstract_preference_learner import AbstractPreferenceLearner, FloatArray, rated
from mala_drake.preferences import UNIFORM_WEIGHTS, validated_weights


@dataclass(frozen=True, slots=True, kw_only=True)
class FixedWeights(AbstractPreferenceLearner):
    """Plans with the same weights always. The state is the number of rated episodes alone.

    Attributes:
        weights: on the simplex; uniform by default.

    Raises:
        BadInput: if the weights are off the simplex.
    """

    weights: tuple[float, ...] = UNIFORM_WEIGHTS

    def __post_init__(self) -> None:
        validated_weights(self.weights, where="learner.weights")

    def initial_state(self) -> FloatArray:
        """The count 0."""
        return np.zeros(1)

    def update(self, state: FloatArray, *, ratings: Sequence[float | None], features: Sequence[float]) -> FloatArray:
        """Counts the episode if anything of it was rated."""
        _, _, mask = rated(ratings, features)
        return state + float(mask.any())

    def updates(self, state: FloatArray) -> int:
        """The number of rated episodes."""
        return int(state[0])

    def estimate(self, state: FloatArray) -> FloatArray:  # noqa: ARG002 (the contract has it)
        """The fixed weights."""
        return np.array(self.weights)

    def deviation(self, state: FloatArray) -> FloatArray | None:  # noqa: ARG002 (the contract has it)
        """None: nothing is estimated."""
        return None

    def planning_weights(self, state: FloatArray, generator: np.random.Generator) -> FloatArray:  # noqa: ARG002
        """The fixed weights, without exploration."""
        return self.estimate(state)
