"""The learned translation (row U7): from preferences to Q and R, moved with the gradients that p^g is learned by.

By the chain rule dC/d gain_ji = dC/d log q_j . d log q_j/d gain_ji. The paper's rate of 0.002 is for its own units;
here it is the share of a Gauss-Newton step, alpha = rate / |dC/d gains|^2, which has no unit. Every leg of every action
moves the one translation a little, so that it becomes an average over what was done.

As with p^g, the part of a gradient by which all weights would grow together is left out. Gains stay where each entry
is between the bounds of `CostTranslation` for all preferences on the simplex, and not only for the present ones. An
entry is affine in them, so that its extremes are at the corners; in the corner of criterion i it is
1 + gain_i - mean(gain) times its working point. So each row, without its mean, is projected onto a box in which it sums
to zero. The mean has no effect and does not move.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION, CostTranslation
from mala_drake.errors import BadInput
from mala_drake.learning.abstract_learner import AbstractLearner, FloatArray
from mala_drake.learning.balanced_box import project_to_balanced_box

_LEAST_SLOPE = 1e-9  # Cost by gain; at uniform preferences the gains have no effect at all.


class TranslationEstimator(AbstractLearner):
    """Estimates the gains of the translation, starting at the default ones.

    Like other learners it holds settings only. What is learned is one vector: the gains row by row, and the number of
    updates.
    """

    def __init__(
        self, *, start: CostTranslation = DEFAULT_TRANSLATION, rate: float = 0.002, trust_radius: float = 0.1
    ) -> None:
        """Constructs the estimator.

        Args:
            start: the translation before any leg, within its bounds on the whole simplex.
            rate: share of a Gauss-Newton step that an update makes, in (0, 1].
            trust_radius: of an update, in the norm of the gains, > 0.

        Raises:
            BadInput: if a number is out of its range.
        """
        if not 0.0 < rate <= 1.0:
            raise BadInput("rate", str(rate), "a number in (0, 1]")
        if not 0.0 < trust_radius < math.inf:
            raise BadInput("trust_radius", str(trust_radius), "a finite number > 0")
        self._shape = start.gains.shape
        self._start = start.gains
        self._lowest, self._highest = start.LOWEST - 1.0, start.HIGHEST - 1.0
        self._rate = rate
        self._trust_radius = trust_radius
        if not np.array_equal(self._projected(self._start), self._start):
            raise BadInput("start", "an entry that leaves its bounds on the simplex", "a translation that does not")

    def initial_state(self) -> FloatArray:
        """The state before any leg: (46,)."""
        return np.append(self._start.ravel(), 0.0)

    def update(self, state: FloatArray, weights: Sequence[float], mismatch: float, gradient: FloatArray) -> FloatArray:
        """The state after one leg; unchanged if it says nothing.

        Args:
            state: before; not modified.
            weights: the preferences that were translated.
            mismatch: E^C, measured minus predicted cost. Numbers that are not finite teach nothing.
            gradient: of the leg's cost by the logarithm of each diagonal entry of Q, then of R, shape (9,).
        """
        if not (math.isfinite(mismatch) and np.isfinite(gradient).all()):
            return state.copy()
        slopes = (gradient - gradient.mean())[:, None] * self.translation(state).log_gradient(weights)
        slope = float(np.linalg.norm(slopes))
        if slope < _LEAST_SLOPE:
            return state.copy()
        wanted = self._rate * mismatch / slope
        bounded = max(-self._trust_radius, min(wanted, self._trust_radius))
        gains = self._projected(self.gains(state) - bounded * slopes / slope)
        return np.append(gains.ravel(), state[-1] + 1.0)

    def gains(self, state: FloatArray) -> FloatArray:
        """The gains, shape (9, 5)."""
        return state[:-1].reshape(self._shape)

    def translation(self, state: FloatArray) -> CostTranslation:
        """From preferences to Q and R."""
        return CostTranslation.of(self.gains(state))

    def updates(self, state: FloatArray) -> int:
        """The number of legs learned from."""
        return int(state[-1])

    def learned(self, state: FloatArray) -> tuple[tuple[float, ...], ...]:
        """The gains for the controller; nothing before the first leg."""
        return tuple(map(tuple, self.gains(state).tolist())) if self.updates(state) else ()

    def _projected(self, gains: FloatArray) -> FloatArray:
        """The gains within bounds; bit for bit the same where they are already."""
        means = gains.mean(axis=1, keepdims=True)
        deviations = gains - means
        inside = (deviations >= self._lowest).all(axis=1) & (deviations <= self._highest).all(axis=1)
        projected = np.array([project_to_balanced_box(row, self._lowest, self._highest) for row in deviations])
        return np.where(inside[:, None], gains, projected + means)
