"""The baseline that plans for another patient every day: random weights in each episode."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mala_drake.learning.abstract_preference_learner import AbstractPreferenceLearner, FloatArray, rated
from mala_drake.preferences import CRITERIA, UNIFORM_WEIGHTS


@dataclass(frozen=True, slots=True)
class RandomWeights(AbstractPreferenceLearner):
    """Plans each episode with weights drawn evenly from the simplex, and learns nothing: its estimate stays uniform.

    The state is the number of rated episodes alone.
    """

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
        """Uniform weights: nothing is known."""
        return np.array(UNIFORM_WEIGHTS)

    def deviation(self, state: FloatArray) -> FloatArray | None:  # noqa: ARG002 (the contract has it)
        """None: nothing is estimated."""
        return None

    def planning_weights(self, state: FloatArray, generator: np.random.Generator) -> FloatArray:  # noqa: ARG002
        """A draw from Dirichlet(1, 1, 1, 1, 1)."""
        return generator.dirichlet(np.ones(len(CRITERIA)))
