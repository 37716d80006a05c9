"""The Bayesian preference learner: a posterior over the weights, not a point."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate

import numpy as np

from mala_drake.errors import BadInput
from mala_drake.learning.abstract_preference_learner import AbstractPreferenceLearner, FloatArray, rated
from mala_drake.learning.cut_rating import cut_rating
from mala_drake.learning.drift_test import ALARM, Prediction, conspicuousness
from mala_drake.learning.rating_evidence import (
    BEST_RATING,
    WORST_RATING,
    Evidence,
    Observation,
)
from mala_drake.learning.simplex_posterior import SimplexPosterior, simplex_posterior
from mala_drake.preferences import CRITERIA

_SIZE = len(CRITERIA)
_WINDOW = 6  # Episodes that are remembered one by one, to find out when a patient changed.
_OUTLIER = 4.0  # Standard deviations of a prediction error beyond which a rating is taken as that far off.
_TRUSTED = 14.0  # Degrees of freedom of the noise estimate from which on a rating can be called an outlier.


@dataclass(frozen=True, slots=True, kw_only=True)
class Posterior(AbstractPreferenceLearner):
    """Bayesian regression of the ratings, r_i = 5 - 4 f_i w_i + eps_i, on the simplex, with unknown noise.

    The prior is uniform on the simplex, and an inverse gamma for the noise variance. The estimate is the posterior
    mean, the deviation the posterior's: a weight whose feature is always near zero stays as uncertain as it was.

    - A rating of exactly 5 or 1 may have been cut there: it counts as a bound, not as a value. Ratings beyond 5 show
      that the patient does not clip, and count as they are.
    - A missing rating says nothing. A rating far off its prediction is taken to be less far off (winsorised).
    - Forgetting acts only on detected drift: the last episodes are tested against all before them (`drift_test.py`).
      When they show that the patient has changed, what the older ones said about the weights is forgotten, and what
      they said about the noise is kept. Without an alarm nothing is ever forgotten, and no precision lost.

    Exploration is Thompson sampling: the next episode is planned with weights drawn from the posterior, so that what is
    uncertain is tried, and the more certain the weights are the less the draws differ. Once no weight's deviation is
    above `exploration_until`, plans are made with the mean. Planning weights only weigh the plan metric, so that
    exploring never relaxes a constraint of the planner or of the controller.

    The state is the evidence (see `Evidence`), the number of rated episodes, and the last few observations.

    Attributes:
        typical_noise: a guess at the standard deviation of a rating.
        noise_confidence: a of the inverse gamma prior; 1.5 leaves the noise open within a factor of about three.
        exploration_until: deviation of a weight below which there is no more exploration; 1 for none at all.

    Raises:
        BadInput: if a number is not positive and finite.
    """

    typical_noise: float = 0.1
    noise_confidence: float = 1.5
    exploration_until: float = 0.03

    def __post_init__(self) -> None:
        for name in ("typical_noise", "noise_confidence", "exploration_until"):
            number = getattr(self, name)
            if not (math.isfinite(number) and number > 0.0):
                raise BadInput(f"learner.{name}", str(number), "a finite number > 0")

    def initial_state(self) -> FloatArray:
        """No evidence, no episode, an empty window."""
        variance = (self.typical_noise / (BEST_RATING - WORST_RATING)) ** 2
        none = Evidence.none(noise_shape=self.noise_confidence, noise_scale=self.noise_confidence * variance)
        return _Memory(none, 0.0).packed()

    def update(self, state: FloatArray, *, ratings: Sequence[float | None], features: Sequence[float]) -> FloatArray:
        """The posterior after one more episode."""
        rating, feature, mask = rated(ratings, features)
        if not mask.any():
            return state.copy()
        memory = _Memory.unpacked(state)
        return memory.with_episode(Observation.of(rating, feature, mask)).packed()

    def updates(self, state: FloatArray) -> int:
        """The number of rated episodes."""
        return int(_Memory.unpacked(state).episodes)

    def estimate(self, state: FloatArray) -> FloatArray:
        """The posterior mean."""
        return self.posterior(state).mean

    def deviation(self, state: FloatArray) -> FloatArray | None:
        """The posterior standard deviations."""
        return self.posterior(state).deviation

    def interval(self, state: FloatArray, probability: float = 0.9) -> FloatArray:
        """The equal-tailed credible interval of each weight: (5, 2)."""
        return self.posterior(state).interval(probability)

    def noise(self, state: FloatArray) -> float:
        """The estimated standard deviation of a rating, sigma."""
        variance = _Memory.unpacked(state).evidence.noise_variance(self.estimate(state))
        return (BEST_RATING - WORST_RATING) * math.sqrt(variance)

    def planning_weights(self, state: FloatArray, generator: np.random.Generator) -> FloatArray:
        """A draw from the posterior, or its mean once all weights are known well enough."""
        posterior = self.posterior(state)
        if posterior.deviation.max() <= self.exploration_until:
            return posterior.mean
        return posterior.draw(generator)

    def posterior(self, state: FloatArray) -> SimplexPosterior:
        """The whole distribution."""
        return _posterior_at(state.tobytes())


@dataclass(frozen=True, slots=True, eq=False)
class _Memory:
    """The state by its parts.

    Attributes:
        past: the evidence of all episodes older than the window.
        episodes: number of rated ones.
        window: the newest ones, the newest last, with nothing of them in `past`.
    """

    past: Evidence
    episodes: float
    window: tuple[Observation, ...] = ()

    @classmethod
    def unpacked(cls, state: FloatArray) -> _Memory:
        past, (episodes, length), rows = np.split(state, [Evidence.SIZE, Evidence.SIZE + 2])
        table = rows.reshape(_WINDOW, Observation.SIZE)[: int(length)]
        window = tuple(Observation(row[:_SIZE].copy(), row[_SIZE:].copy()) for row in table)
        return cls(Evidence.unpacked(past), float(episodes), window)

    def packed(self) -> FloatArray:
        table = np.zeros((_WINDOW, Observation.SIZE))
        for row, observation in zip(table, self.window, strict=False):
            row[:] = np.concatenate([observation.features, observation.ratings])
        return np.concatenate([self.past.packed(), [self.episodes, len(self.window)], table.ravel()])

    @property
    def evidence(self) -> Evidence:
        """Of all episodes."""
        return self._evidences()[-1]

    def _evidences(self) -> list[Evidence]:
        """Before the window, and after each of its episodes."""
        return list(accumulate(self.window, learned, initial=self.past))

    def with_episode(self, observation: Observation) -> _Memory:
        """One more episode; forgets the past where the newest ones show that the patient has changed."""
        past, window = self.past, (*self.window, observation)
        if len(window) > _WINDOW:
            past, window = learned(past, window[0]), window[1:]
        grown = _Memory(past, self.episodes + 1.0, window)
        evidences = grown._evidences()
        found = [conspicuousness(window[k:], _prediction(evidences[k])) for k in range(len(window) - 1)]
        if not found or max(found) < ALARM:
            return grown
        onset = found.index(max(found))
        before = evidences[onset]
        return _Memory(before.forgotten(_posterior_of(before).mean), grown.episodes, window[onset:])


def learned(evidence: Evidence, observation: Observation) -> Evidence:
    """The evidence with one more episode: outliers drawn in, cut ratings as bounds."""
    before = _prediction(evidence)
    expected = observation.features * before.weights
    spread = np.sqrt(before.noise**2 + observation.features**2 * before.variances)
    reach = _OUTLIER * spread if before.degrees_of_freedom >= _TRUSTED else np.full(_SIZE, math.inf)
    values = np.where(observation.plain, observation.values, np.nan)
    evidence = evidence.with_values(observation.features, np.clip(values, expected - reach, expected + reach))
    for clipped, below in ((observation.clipped_high, True), (observation.clipped_low, False)):
        for i in np.flatnonzero(clipped & (observation.features > 0.0)).tolist():
            limit = np.clip(observation.values[i], expected[i] - reach[i], expected[i] + reach[i])
            cut = cut_rating(
                float(observation.features[i]),
                float(limit),
                below=below,
                mean=float(before.weights[i]),
                deviation=math.sqrt(before.variances[i]),
                noise=before.noise,
            )
            evidence = evidence.with_cut(i, cut)
    return evidence


def _prediction(evidence: Evidence) -> Prediction:
    posterior = _posterior_of(evidence)
    noise = math.sqrt(evidence.noise_variance(posterior.mean))
    return Prediction(posterior.mean, posterior.deviation**2, noise, evidence.degrees_of_freedom)


@lru_cache(maxsize=4)
def _posterior_at(state: bytes) -> SimplexPosterior:
    """The posterior of a state, which is asked for its mean, its deviation and a draw in turn."""
    return _posterior_of(_Memory.unpacked(np.frombuffer(state)).evidence)


def _posterior_of(evidence: Evidence) -> SimplexPosterior:
    """The posterior for some evidence; an episode asks for it anew as long as it is in the window."""
    return _posterior_of_packed(evidence.packed().tobytes())


@lru_cache(maxsize=4 * _WINDOW)
def _posterior_of_packed(evidence: bytes) -> SimplexPosterior:
    return simplex_posterior(Evidence.unpacked(np.frombuffer(evidence)))
