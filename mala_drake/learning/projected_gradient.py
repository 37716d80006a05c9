"""The paper's preference learner: projected gradient descent on the simplex."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mala_drake.errors import BadInput
from mala_drake.learning.abstract_preference_learner import AbstractPreferenceLearner, FloatArray, rated
from mala_drake.learning.simplex import project_onto_simplex
from mala_drake.preferences import CRITERIA, UNIFORM_WEIGHTS, validated_weights

_SIZE = len(CRITERIA)


@dataclass(frozen=True, slots=True, kw_only=True)
class ProjectedGradient(AbstractPreferenceLearner):
    """w <- Proj(w - eta 4 f (r - r_hat)) with the predicted ratings r_hat_i = 5 - 4 f_i w_i.

    The paper names neither loss nor decay law. The loss taken is L(w) = 1/2 sum_i (r_i - r_hat_i)^2: because
    d r_hat_i / d w_i = -4 f_i, its gradient is dL/dw_i = 4 f_i (r_i - r_hat_i), so the step above descends it.
    It converges for eta < 1/8 whatever the features in [0, 1] are, the curvature being 16 f_i^2.

    Exploration adds N(0, s_n^2) noise to each weight and projects: s_n = exploration / (1 + exploration_decay n),
    where n counts from 1, being one more than the number of rated episodes so far.

    The public reference implementation of the paper departs from this in three ways, each an option here and all
    together `reference_variant`: the step eta_n = eta / (1 + step_decay n) shrinks; the new weights are the average
    `mixing` new + (1 - mixing) old; and a bias b_i of each criterion's ratings is learned with the same step, the
    predicted ratings being 5 - 4 f_i w_i + b_i.

    The state is the five weights, the number of rated episodes, and the five biases.

    Attributes:
        step_size: eta.
        step_decay: how fast the step falls with n, the number of this rated episode from 1; 0 in the paper.
        mixing: share of the new weights, in (0, 1]; 1 in the paper.
        learn_bias: whether a bias is learned; not in the paper.
        exploration: standard deviation of the planning weights' noise at n = 0.
        exploration_decay: how fast it falls.
        initial_weights: on the simplex; uniform when nothing is known about the patient.

    Raises:
        BadInput: if a number is negative or not finite, or the weights are off the simplex.
    """

    step_size: float = 0.12
    step_decay: float = 0.0
    mixing: float = 1.0
    learn_bias: bool = False
    exploration: float = 0.15
    exploration_decay: float = 0.2
    initial_weights: tuple[float, ...] = UNIFORM_WEIGHTS

    def __post_init__(self) -> None:
        for name in ("step_size", "step_decay", "exploration", "exploration_decay"):
            number = getattr(self, name)
            if not (math.isfinite(number) and number >= 0.0):
                raise BadInput(f"learner.{name}", str(number), "a finite number >= 0")
        if not 0.0 < self.mixing <= 1.0:
            raise BadInput("learner.mixing", str(self.mixing), "a number in (0, 1]")
        validated_weights(self.initial_weights, where="learner.initial_weights")

    @classmethod
    def reference_variant(cls, **settings: Any) -> ProjectedGradient:
        """The learner of the paper's public reference implementation; other settings as given."""
        return cls(step_decay=0.15, mixing=0.6, learn_bias=True, **settings)

    def initial_state(self) -> FloatArray:
        """The initial weights, the count 0 and no bias."""
        return np.array([*self.initial_weights, 0.0, *np.zeros(_SIZE)])

    def update(self, state: FloatArray, *, ratings: Sequence[float | None], features: Sequence[float]) -> FloatArray:
        """One projected gradient step on the criteria that were rated; the state unchanged if none was."""
        rating, feature, mask = rated(ratings, features)
        if not mask.any():
            return state.copy()
        weights, count, bias = state[:_SIZE], state[_SIZE] + 1.0, state[_SIZE + 1 :]
        error = np.where(mask, rating - (5.0 - 4.0 * feature * weights + bias), 0.0)
        step = self.step_size / (1.0 + self.step_decay * count)
        moved = project_onto_simplex(weights - step * 4.0 * feature * error)
        # Written so that with the paper's mixing of 1 the new weights are taken to the last bit.
        mixed = moved + (1.0 - self.mixing) * (weights - moved)
        return np.concatenate((mixed, [count], bias + step * error if self.learn_bias else bias))

    def updates(self, state: FloatArray) -> int:
        """The number of rated episodes."""
        return int(state[_SIZE])

    def estimate(self, state: FloatArray) -> FloatArray:
        """The weights w."""
        return state[:_SIZE].copy()

    def deviation(self, state: FloatArray) -> FloatArray | None:  # noqa: ARG002 (the contract has it)
        """None: a point estimate."""
        return None

    def exploration_deviation(self, state: FloatArray) -> float:
        """The standard deviation s_n of the next planning weights' noise."""
        return self.exploration / (1.0 + self.exploration_decay * (self.updates(state) + 1))

    def planning_weights(self, state: FloatArray, generator: np.random.Generator) -> FloatArray:
        """Proj(w + s_n N(0, I))."""
        noise = self.exploration_deviation(state) * generator.standard_normal(_SIZE)
        return project_onto_simplex(self.estimate(state) + noise)
