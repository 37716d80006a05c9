"""Learned costs (rows F2, F3): predictions corrected by what executed actions really cost.

The paper's eq. updateavf with its slips set right (its label stands twice, Phi^C stands where theta^C belongs, the
gradient has no step size, and a reward is compared with a cost): for the measured cost C of an action,

    theta <- theta + gamma dPhi/dtheta (C - Phi(theta; s, a)).

All cost terms of an action are measured one by one, and each is a parameter itself, so that dPhi/dtheta is 1 for the
parameters that predicted the action and 0 for all others. With gamma = 1 / (n + n_0), a Robbins-Monro sequence, theta
is the mean of n measurements and of the prediction, which counts as n_0 of them. theta^T is updated in the same way
when the goal is reached, by the measurement of the hand-over.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput
from mala_drake.learning.abstract_learner import AbstractLearner, FloatArray
from mala_drake.messages import Atom, LearnedCosts
from mala_drake.ward.cost_parameters import LEG_COSTS, LEG_RESERVE

BoolArray = npt.NDArray[np.bool_]

_FIRST_LEGS = 5.0  # Legs driven exactly as predicted that the belief in the predictions is worth.


class CostEstimator(AbstractLearner):
    """Estimates cost parameters from measurements, starting at their predictions.

    What legs teach is in part true of all legs: in each of time, risk, charge and discomfort, the predictions of all
    legs are scaled by the ratio of measured to predicted over the legs driven (least squares through the origin; each
    leg counts once, however often it was driven) before they enter the means. Otherwise a leg would look cheap, or
    dear, only for having been driven. The reserve of a leg is no mean: it is the most that was measured, slowly
    forgotten, and as predicted before. The planner counts on no less than the mean (`planning.learned_costs`), which is
    what legs in general teach of the reserve of one not driven.

    Like other learners it holds settings only; what it has learned is one vector of numbers: a mean and a count of each
    parameter, and the number of actions learned from.

    Attributes:
        names: the parameters, as ground fluents, in the order of the state.
    """

    def __init__(
        self, predictions: Mapping[Atom, float], *, prediction_weight: float = 1.0, least_step: float = 0.05
    ) -> None:
        """Constructs the estimator.

        Args:
            predictions: of every parameter, >= 0.
            prediction_weight: n_0, how many measurements a prediction is worth, > 0.
            least_step: below which gamma does not fall, so that lasting changes are followed; in [0, 1].

        Raises:
            BadInput: if a number is out of its range.
        """
        if not (math.isfinite(prediction_weight) and prediction_weight > 0.0):
            raise BadInput("prediction_weight", str(prediction_weight), "a finite number > 0")
        if not 0.0 <= least_step <= 1.0:
            raise BadInput("least_step", str(least_step), "a number in [0, 1]")
        for name, value in predictions.items():
            if not (math.isfinite(value) and value >= 0.0):
                raise BadInput(f"prediction of ({' '.join(name)})", str(value), "a finite number >= 0")
        self.names: tuple[Atom, ...] = tuple(sorted(predictions))
        self._index = {name: i for i, name in enumerate(self.names)}
        self._predictions = np.array([predictions[name] for name in self.names])
        self._weight = prediction_weight
        self._least_step = least_step
        self._is_reserve = np.array([name[0] == LEG_RESERVE for name in self.names], dtype=bool)
        kinds = [LEG_COSTS.index(name[0]) if name[0] in LEG_COSTS else -1 for name in self.names]
        self._kinds = np.array(kinds, dtype=int)

    def initial_state(self) -> FloatArray:
        """The state before any action: (2 n + 1,) for n parameters."""
        return np.zeros(2 * len(self.names) + 1)

    def update(self, state: FloatArray, observed: Mapping[Atom, float]) -> FloatArray:
        """The state after one action; unchanged if it says nothing of any parameter.

        Args:
            state: before; not modified.
            observed: measurements by parameter. Unknown parameters and numbers that are not finite are left out.
        """
        after = state.copy()
        means, counts = self._parts(after)
        known = {self._index[name]: value for name, value in observed.items() if name in self._index}
        known = {i: value for i, value in known.items() if math.isfinite(value)}
        for i, value in known.items():
            means[i] += self._step(i, counts[i], rising=value > means[i]) * (value - means[i])
            counts[i] += 1.0
        after[-1] += bool(known)
        return after

    def updates(self, state: FloatArray) -> int:
        """The number of actions learned from."""
        return int(state[-1])

    def leg_scales(self, state: FloatArray) -> FloatArray:
        """How many times the predicted time, risk, charge and discomfort legs take in general: (4,)."""
        means, counts = self._parts(state)
        return np.array([self._scale(means, counts, self._kinds == kind) for kind in range(len(LEG_COSTS))])

    def estimates(self, state: FloatArray) -> FloatArray:
        """What each parameter is believed to be: (n,)."""
        means, counts = self._parts(state)
        scales = np.where(self._kinds >= 0, self.leg_scales(state)[self._kinds], 1.0)
        most = np.inf if self._least_step == 0.0 else 1.0 / self._least_step
        seen = np.minimum(counts, most)
        estimates: FloatArray = (self._weight * scales * self._predictions + seen * means) / (self._weight + seen)
        estimates[self._is_reserve] = np.where(counts > 0.0, means, self._predictions)[self._is_reserve]
        return estimates

    def learned(self, state: FloatArray) -> LearnedCosts:
        """What the planner is told; nothing before the first action."""
        if self.updates(state) == 0:
            return LearnedCosts()
        values = tuple(zip(self.names, self.estimates(state).tolist(), strict=True))
        return LearnedCosts(values, tuple(self.leg_scales(state).tolist()), self.updates(state))

    def _step(self, parameter: int, count: float, *, rising: bool) -> float:
        """gamma, after `count` measurements."""
        if self._is_reserve[parameter]:
            return 1.0 if rising or count == 0.0 else self._least_step
        return max(1.0 / (count + 1.0), self._least_step)

    def _scale(self, means: FloatArray, counts: FloatArray, legs: BoolArray) -> float:
        """Measured by predicted over some legs, drawn to 1 while few of them were driven."""
        predicted = self._predictions[legs]
        typical = float(np.mean(predicted**2)) if legs.any() else 0.0
        known = counts[legs] / (counts[legs] + self._weight)
        if typical == 0.0:
            return 1.0
        first = _FIRST_LEGS * typical
        return float((first + known @ (predicted * means[legs])) / (first + known @ predicted**2))

    def _parts(self, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Views of means and counts, (n,) each."""
        n = len(self.names)
        return state[:n], state[n : 2 * n]
