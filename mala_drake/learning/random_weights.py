"""The baseline that plans for another patient every day: random weights in each episode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mala_drake.learning.abstract_preference_learner import FloatArray
from mala_drake.learning.fixed_weights import FixedWeights
from mala_drake.preferences import CRITERIA


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomWeights(FixedWeights):
    """Plans each episode with weights drawn evenly from the simplex, and learns nothing: its estimate stays as it was.

    The state is the number of rated episodes alone.
    """

    def planning_weights(self, state: FloatArray, generator: np.random.Generator) -> FloatArray:  # noqa: ARG002
        """A draw from Dirichlet(1, 1, 1, 1, 1)."""
        return generator.dirichlet(np.ones(len(CRITERIA)))
