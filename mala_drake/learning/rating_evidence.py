"""What ratings say about the weights, as sums: the numbers that a Bayesian learner keeps.

With y_i = (5 - r_i) / 4 the rating model r_i = 5 - 4 f_i w_i + eps_i is a linear regression, y_i = f_i w_i + s e_i with
s = sigma / 4 and e_i standard normal. Everything that ratings tell about w is then in the residual sum of squares

    RSS(w) = sum (y_i - f_i w_i)^2 = squares - 2 moment' w + w' diag(information) w.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from mala_drake.learning.cut_rating import CutRating
from mala_drake.preferences import CRITERIA

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

BEST_RATING, WORST_RATING = 5.0, 1.0
"""Ratings are cut there by a patient who clips."""

_PER_FEATURE = BEST_RATING - WORST_RATING
_SIZE = len(CRITERIA)


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """One rated episode, five numbers each. A criterion that was not rated has the feature 0 and the rating 5.

    Attributes:
        features: measured f in [0, 1].
        ratings: r.
    """

    features: FloatArray
    ratings: FloatArray

    SIZE = 2 * _SIZE

    @classmethod
    def of(cls, ratings: FloatArray, features: FloatArray, rated: BoolArray) -> Observation:
        """The observation of an episode in which the criteria of the mask were rated."""
        return cls(np.where(rated, features, 0.0), np.where(rated, ratings, BEST_RATING))

    @property
    def values(self) -> FloatArray:
        """Y = (5 - r) / 4."""
        return (BEST_RATING - self.ratings) / _PER_FEATURE

    @property
    def clipped_high(self) -> BoolArray:
        """Where the rating is exactly the best one: it may have been cut to it."""
        return self.ratings == BEST_RATING

    @property
    def clipped_low(self) -> BoolArray:
        """Where the rating is exactly the worst one."""
        return self.ratings == WORST_RATING

    @property
    def plain(self) -> BoolArray:
        """Where the rating counts as it is."""
        return ~(self.clipped_high | self.clipped_low)


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """The sums over the ratings of one patient since the last change of mind.

    Attributes:
        information: sum of f_i^2, (5,).
        moment: sum of f_i y_i, (5,).
        squares: sum of y_i^2.
        count: number of ratings; of one that was cut, what it tells of the noise as a part of one that was not.
        noise_shape: a of the inverse-gamma belief about s^2 before these ratings.
        noise_scale: b of it.
    """

    information: FloatArray
    moment: FloatArray
    squares: float
    count: float
    noise_shape: float
    noise_scale: float

    SIZE = 2 * _SIZE + 4

    @classmethod
    def none(cls, *, noise_shape: float, noise_scale: float) -> Evidence:
        """No ratings yet."""
        return cls(np.zeros(_SIZE), np.zeros(_SIZE), 0.0, 0.0, noise_shape, noise_scale)

    @classmethod
    def unpacked(cls, vector: FloatArray) -> Evidence:
        """The evidence that `packed` has put into a vector of `SIZE` numbers."""
        squares, count, shape, scale = vector[2 * _SIZE :].tolist()
        return cls(vector[:_SIZE].copy(), vector[_SIZE : 2 * _SIZE].copy(), squares, count, shape, scale)

    def packed(self) -> FloatArray:
        """All numbers in one vector."""
        scalars = [self.squares, self.count, self.noise_shape, self.noise_scale]
        return np.concatenate([self.information, self.moment, scalars])

    def residual_squares(self, weights: FloatArray) -> FloatArray:
        """RSS(w) for weights of shape (..., 5)."""
        return self.squares - 2.0 * (weights @ self.moment) + weights**2 @ self.information

    def noise_variance(self, weights: FloatArray) -> float:
        """The expected s^2 if these were the true weights: (b + RSS / 2) / (a + n / 2)."""
        scale = self.noise_scale + 0.5 * max(float(self.residual_squares(weights)), 0.0)
        return scale / (self.noise_shape + 0.5 * self.count)

    @property
    def degrees_of_freedom(self) -> float:
        """How much is known about the noise, as a number of residuals."""
        return max(2.0 * self.noise_shape + self.count - (_SIZE - 1), 1.0)

    def with_values(self, features: FloatArray, values: FloatArray) -> Evidence:
        """Takes in ratings: matching arrays of features and values y, with an entry a criterion or NaN for none."""
        rated = ~np.isnan(values)
        features, values = np.where(rated, features, 0.0), np.where(rated, values, 0.0)
        return replace(
            self,
            information=self.information + features**2,
            moment=self.moment + features * values,
            squares=self.squares + float(values @ values),
            count=self.count + float(np.count_nonzero(rated)),
        )

    def with_cut(self, criterion: int, cut: CutRating) -> Evidence:
        """Takes in what a cut rating says about the weight of its criterion and about the noise."""
        information, moment = self.information.copy(), self.moment.copy()
        information[criterion] += cut.precision
        moment[criterion] += cut.precision * cut.mean
        squares = self.squares + cut.precision * cut.mean**2 + cut.squares
        return replace(self, information=information, moment=moment, squares=squares, count=self.count + cut.count)

    def forgotten(self, weights: FloatArray) -> Evidence:
        """Nothing is known about the weights any more; what was learned about the noise stays."""
        learned = max(self.count - (_SIZE - 1), 0.0)
        residual = max(float(self.residual_squares(weights)), 0.0) if learned else 0.0
        return Evidence.none(
            noise_shape=self.noise_shape + 0.5 * learned, noise_scale=self.noise_scale + 0.5 * residual
        )
