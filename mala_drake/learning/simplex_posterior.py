"""The posterior distribution of weights on the simplex, by importance sampling with fixed draws.

With a uniform prior on the simplex and an inverse-gamma prior IG(a, b) on the noise variance, the noise integrates out,

    p(w | ratings) proportional to (b + RSS(w) / 2)^-(a + n / 2)    on the simplex,

a multivariate t distribution cut off at the simplex's faces. Its moments have no closed form. They are computed from
points drawn half from the uncut distribution and half from the whole simplex (a defensive mixture: Owen & Zhou, "Safe
and effective importance sampling", 2000), so that both a vague and a sharp posterior are well covered. Near a corner,
where hardly any of the uncut distribution lies on the simplex, the effective sample size (Kish) shows it, and the
points then walk to the posterior (`simplex_walk.py`). The underlying random numbers are always the same: the posterior
is a function of the evidence alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from mala_drake.learning.information_bound import sum_zero_basis
from mala_drake.learning.rating_evidence import Evidence
from mala_drake.learning.simplex import project_onto_simplex
from mala_drake.learning.simplex_walk import walk_on_simplex
from mala_drake.preferences import CRITERIA

FloatArray = npt.NDArray[np.float64]

_SIZE = len(CRITERIA)
_FREEDOM = _SIZE - 1  # Dimension of the simplex.
_BASIS = sum_zero_basis(_SIZE)
_HALF = 2050  # Points of each component of the mixture.
_ROUNDS, _SETTLED = 20, 1e-4  # Of the search for the middle of the posterior, and when it ends.
_TAIL = 6.0  # Degrees of freedom of the drawn t distribution: heavier tails than any posterior but the vaguest.
_ENOUGH = 300.0  # As many equally probable points must tell as much as the weighted ones do.
_WALKERS = 1000
_VOLUME = math.sqrt(_SIZE) / math.factorial(_FREEDOM)  # Of the simplex, in its own dimension.
_SIMPLEX_DEVIATION = math.sqrt((_SIZE - 1.0) / (_SIZE**2 * (_SIZE + 1.0)))  # Of a weight that nothing is known about.


@dataclass(frozen=True, slots=True, eq=False)
class SimplexPosterior:
    """Weighted points that stand for a distribution on the simplex.

    Attributes:
        points: (k, 5), each on the simplex.
        probabilities: (k,), with the sum 1.
    """

    points: FloatArray
    probabilities: FloatArray

    @property
    def mean(self) -> FloatArray:
        """The expected weights, (5,): on the simplex, as all points are."""
        mean: FloatArray = self.probabilities @ self.points
        return mean / mean.sum()

    @property
    def covariance(self) -> FloatArray:
        """The covariance of the weights, (5, 5); singular, since they sum to one."""
        centred = self.points - self.mean
        covariance: FloatArray = centred.T @ (self.probabilities[:, None] * centred)
        return covariance

    @property
    def effective_size(self) -> float:
        """As many equally probable points would tell as much (Kish): at most the number of points."""
        return 1.0 / float(self.probabilities @ self.probabilities)

    @property
    def deviation(self) -> FloatArray:
        """The standard deviation of each weight, (5,)."""
        return np.sqrt(np.diag(self.covariance))

    def interval(self, probability: float) -> FloatArray:
        """The equal-tailed credible interval of each weight: lower and upper ends, (5, 2)."""
        tails = np.array([0.5 * (1.0 - probability), 0.5 * (1.0 + probability)])
        return np.array([_quantiles(column, self.probabilities, tails) for column in self.points.T])

    def resampled(self, count: int) -> FloatArray:
        """Equally probable points, (count, 5): evenly spaced in the cumulative probability."""
        cumulative = np.cumsum(self.probabilities)
        levels = (np.arange(count) + 0.5) / count * cumulative[-1]
        return self.points[np.searchsorted(cumulative, levels)]

    def draw(self, generator: np.random.Generator) -> FloatArray:
        """Weights drawn at random from the distribution: (5,)."""
        cumulative = np.cumsum(self.probabilities)
        index = int(np.searchsorted(cumulative, generator.random() * cumulative[-1]))
        return self.points[min(index, len(self.points) - 1)].copy()


def simplex_posterior(evidence: Evidence) -> SimplexPosterior:
    """The posterior for what has been rated so far; the uniform distribution before anything has."""
    if evidence.count == 0.0 and not evidence.information.any():
        uniform = _draws()[1]
        return _of_equal_points(uniform)
    sampled = _sampled(evidence)
    if sampled.effective_size >= _ENOUGH:
        return sampled
    return _of_equal_points(walk_on_simplex(evidence, sampled.resampled(_WALKERS)))


def _of_equal_points(points: FloatArray) -> SimplexPosterior:
    return SimplexPosterior(points, np.full(len(points), 1.0 / len(points)))


def _sampled(evidence: Evidence) -> SimplexPosterior:
    """By importance sampling."""
    centre, factor = _centre_and_factor(evidence)
    normals, uniform = _draws()
    near = centre + normals @ factor.T
    points = np.vstack((near[(near >= 0.0).all(axis=1)], uniform))
    exponent = evidence.noise_shape + 0.5 * evidence.count
    log_target = -exponent * np.log(evidence.noise_scale + 0.5 * np.maximum(evidence.residual_squares(points), 0.0))
    log_weights = log_target - np.log(_mixture_density(points, centre, factor))
    weights = np.exp(log_weights - log_weights.max())
    return SimplexPosterior(points, weights / weights.sum())


def _centre_and_factor(evidence: Evidence) -> tuple[FloatArray, FloatArray]:
    """Mean, (5,), and a factor L, (5, 4), of the covariance L L' of a Gaussian near the posterior, to draw points by.

    The uniform prior counts as a Gaussian of the simplex's own width.
    """
    basis, middle = _BASIS, np.full(_SIZE, 1.0 / _SIZE)
    prior = np.eye(_FREEDOM) / _SIMPLEX_DEVIATION**2
    centre, precision = middle, prior
    for _ in range(_ROUNDS):  # The noise level depends on the centre and the other way round.
        variance = evidence.noise_variance(centre)
        precision = prior + basis.T @ (evidence.information[:, None] * basis) / variance
        gradient = basis.T @ (evidence.moment - evidence.information * middle) / variance
        moved = project_onto_simplex(middle + basis @ np.linalg.solve(precision, gradient))
        settled = np.abs(moved - centre).max() < _SETTLED
        centre = moved
        if settled:
            break
    return centre, basis @ np.linalg.cholesky(np.linalg.inv(precision))


def _mixture_density(points: FloatArray, centre: FloatArray, factor: FloatArray) -> FloatArray:
    """The density that points on the simplex are drawn from, within its four dimensions, up to a constant factor.

    Both components have the same number of draws. Those of the t component that fall off the simplex are left out:
    there the target is zero.
    """
    inner = _BASIS.T @ factor  # (4, 4), lower triangular.
    standardised = np.linalg.solve(inner, _BASIS.T @ (points - centre).T)
    log_norm = (
        math.lgamma(0.5 * (_TAIL + _FREEDOM))
        - math.lgamma(0.5 * _TAIL)
        - 0.5 * _FREEDOM * math.log(_TAIL * math.pi)
        - math.log(abs(np.linalg.det(inner)))
    )
    squares = (standardised**2).sum(axis=0)
    near = np.exp(log_norm - 0.5 * (_TAIL + _FREEDOM) * np.log1p(squares / _TAIL))
    return 0.5 * near + 0.5 / _VOLUME


@cache
def _draws() -> tuple[FloatArray, FloatArray]:
    """The fixed random numbers: t-distributed vectors (k, 4), and points spread evenly over the simplex (k, 5)."""
    generator = np.random.Generator(np.random.PCG64(20))
    normals = generator.standard_normal((_HALF // 2, _FREEDOM))
    scales = np.sqrt(_TAIL / generator.chisquare(_TAIL, _HALF // 2))
    tails = scales[:, None] * normals
    draws = np.vstack((tails, -tails))  # Antithetic: their mean is exactly zero.
    some = generator.dirichlet(np.ones(_SIZE), _HALF // _SIZE)
    uniform = np.vstack([np.roll(some, shift, axis=1) for shift in range(_SIZE)])  # No criterion is special.
    for array in (draws, uniform):
        array.setflags(write=False)
    return draws, uniform


def _quantiles(values: FloatArray, probabilities: FloatArray, levels: FloatArray) -> FloatArray:
    """Quantiles of a weighted sample, interpolated between the middles of its steps."""
    order = np.argsort(values, kind="stable")
    cumulative = np.cumsum(probabilities[order])
    middles = (cumulative - 0.5 * probabilities[order]) / cumulative[-1]
    return np.interp(levels, middles, values[order])
