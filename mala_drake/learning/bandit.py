"""The baseline that tries a few fixed weightings and keeps the one that is rated best: UCB1 over arms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mala_drake.errors import BadInput
from mala_drake.learning.abstract_preference_learner import AbstractPreferenceLearner, FloatArray, rated
from mala_drake.preferences import CRITERIA, UNIFORM_WEIGHTS

_SIZE = len(CRITERIA)


def _arms(emphasis: float) -> FloatArray:
    """Uniform weights, then for each criterion weights that stress it: (6, 5)."""
    stressed = np.full((_SIZE, _SIZE), (1.0 - emphasis) / (_SIZE - 1))
    np.fill_diagonal(stressed, emphasis)
    return np.vstack((UNIFORM_WEIGHTS, stressed))


@dataclass(frozen=True, slots=True, kw_only=True)
class Bandit(AbstractPreferenceLearner):
    """UCB1 (Auer, Cesa-Bianchi & Fischer, 2002) over six weight vectors: uniform, and one that stresses each criterion.

    The reward of an episode is its mean rating, brought to [0, 1]. No rating moves the weights themselves: this learner
    knows which arm is rated best, not what the patient wants. The arm of the next episode follows from the state, so an
    update credits the arm that was planned with.

    Learners are not told of failures. A failed episode is one that nobody rates, and what is not rated credits no arm:
    an arm whose episodes all fail stays the next one for ever.

    The state is, for each arm, the number of rated episodes and the sum of their rewards.

    Attributes:
        emphasis: weight of the stressed criterion in its arm.

    Raises:
        BadInput: if the emphasis is not in (1/5, 1].
    """

    emphasis: float = 0.6

    def __post_init__(self) -> None:
        if not 1.0 / _SIZE < self.emphasis <= 1.0:
            raise BadInput("learner.emphasis", str(self.emphasis), f"a number in ({1.0 / _SIZE:g}, 1]")

    def initial_state(self) -> FloatArray:
        """No arm has been tried."""
        return np.zeros(2 * (_SIZE + 1))

    def update(self, state: FloatArray, *, ratings: Sequence[float | None], features: Sequence[float]) -> FloatArray:
        """Credits the arm that was planned with."""
        rating, _, mask = rated(ratings, features)
        after = state.copy()
        if mask.any():
            arm = self.arm(state)
            after[arm] += 1.0
            after[_SIZE + 1 + arm] += (float(rating[mask].mean()) - 1.0) / 4.0
        return after

    def arm(self, state: FloatArray) -> int:
        """Index of the next arm: each once, then the one with the highest upper confidence bound."""
        counts, sums = np.split(state, 2)
        if (counts == 0.0).any():
            return int(np.argmin(counts))
        return int(np.argmax(sums / counts + np.sqrt(2.0 * math.log(counts.sum()) / counts)))

    def updates(self, state: FloatArray) -> int:
        """The number of rated episodes."""
        return int(np.split(state, 2)[0].sum())

    def estimate(self, state: FloatArray) -> FloatArray:
        """The weights of the arm with the best mean reward; uniform before any."""
        counts, sums = np.split(state, 2)
        means = np.divide(sums, counts, out=np.full_like(sums, -np.inf), where=counts > 0.0)
        estimate: FloatArray = _arms(self.emphasis)[int(np.argmax(means))]
        return estimate

    def deviation(self, state: FloatArray) -> FloatArray | None:  # noqa: ARG002 (the contract has it)
        """None: a point estimate."""
        return None

    def planning_weights(self, state: FloatArray, generator: np.random.Generator) -> FloatArray:  # noqa: ARG002
        """The weights of the next arm."""
        weights: FloatArray = _arms(self.emphasis)[self.arm(state)]
        return weights
