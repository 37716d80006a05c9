"""Has the patient changed? A test of the newest episodes against all that came before.

Each rating's prediction error is standardised by its own standard deviation, s^2 (1 + f^2 v) with the weight's variance
s^2 v. Over a window of episodes the errors of one criterion are combined to the score of a shift of its weight, and the
scores of all criteria to a statistic that follows an F distribution as long as nothing has changed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.learning.rating_evidence import Observation

FloatArray = npt.NDArray[np.float64]

ALARM = 4.0
"""Standard deviations of the (normalised) statistic at which a change is believed: 3 in 100,000 a test."""

_STRANGEST = 4.0  # Standard deviations beyond which a rating does not count as stranger still.
_LEAST_FREEDOM = 14.0  # Residuals that must be known before a change is thought of.


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """What is believed before some episodes are rated.

    Attributes:
        weights: expected weights, (5,).
        variances: of the weights, (5,).
        noise: s, the standard deviation of a value y.
        degrees_of_freedom: of the noise estimate.
    """

    weights: FloatArray
    variances: FloatArray
    noise: float
    degrees_of_freedom: float


def conspicuousness(episodes: Sequence[Observation], prediction: Prediction) -> float:
    """How badly episodes fit the prediction, as a standard normal number; minus infinity when nothing can be said.

    A single strange episode is no change of mind: what counts is what is left when the most conspicuous one of at
    least two episodes is taken out.
    """
    if len(episodes) < 2 or prediction.degrees_of_freedom < _LEAST_FREEDOM:
        return -math.inf
    return min(
        _misfit([episode for j, episode in enumerate(episodes) if j != out], prediction) for out in range(len(episodes))
    )


def _misfit(episodes: Sequence[Observation], prediction: Prediction) -> float:
    """The statistic of all these episodes as a standard normal number."""
    plain = np.array([episode.plain for episode in episodes])
    features = np.where(plain, [episode.features for episode in episodes], 0.0)
    reach = _STRANGEST * np.sqrt(prediction.noise**2 + features**2 * prediction.variances)
    errors = np.clip(np.array([episode.values for episode in episodes]) - features * prediction.weights, -reach, reach)
    information = (features**2).sum(axis=0)
    known = information > 0.0
    if not known.any():
        return -math.inf
    scores = (features * errors).sum(axis=0)[known]
    spread = information[known] * (prediction.noise**2 + information[known] * prediction.variances[known])
    statistic = float(np.mean(scores**2 / spread))
    return standard_normal_of_f(statistic, int(np.count_nonzero(known)), prediction.degrees_of_freedom)


def standard_normal_of_f(statistic: float, numerator: float, denominator: float) -> float:
    """The standard normal quantile that corresponds to an F statistic (Paulson's approximation, 1942).

    Args:
        statistic: >= 0.
        numerator: degrees of freedom.
        denominator: degrees of freedom; at least about 3 for the approximation to be good.
    """
    first, second = 2.0 / (9.0 * numerator), 2.0 / (9.0 * denominator)
    root = statistic ** (1.0 / 3.0)
    return ((1.0 - second) * root - (1.0 - first)) / math.sqrt(second * root**2 + first)
