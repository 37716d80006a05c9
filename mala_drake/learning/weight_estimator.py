"""Learned weights (row U6): p^g by action, moved so that what the action costs comes nearer to what was predicted.

The paper's p^g <- p^g - alpha E^C dC/dp^g. p^g are factors on the position, yaw and velocity entries of Q (with those
of W) and on R, by their logarithms, for each place that a leg can lead to; C is the action's cost (see `leg_cost` for
why not G). A constant alpha has to be chosen by leg, because slopes differ by orders of magnitude; Gauss and Newton's
alpha = gain / |dC/dp^g|^2 has not.

The gradient is the model's, and local, while a real leg has events that come a tick sooner or later. So each step is
put to the test, as in any trust-region method (J. Nocedal and S. Wright, Numerical Optimization, ch. 4). If the next
leg to the place is nearer to its prediction, the trust radius doubles, up to its first value. If not, the step is taken
back, and the radius becomes half the step's length. But a leg may also cost more because something else has changed,
and what reappears is to be learned again: a small share of the first radius always remains, and a step that was not
longer than that is not blamed.

A common factor of all weights changes nothing about the optimum, so that learning could shrink them all together for
nothing. The logarithms therefore sum to zero: one group grows at the expense of the others. And none leaves its bounds,
so that Q and R stay positive definite.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE, StateIndex
from mala_drake.errors import BadInput
from mala_drake.learning.abstract_learner import AbstractLearner, FloatArray
from mala_drake.learning.balanced_box import project_to_balanced_box

WEIGHT_GROUPS = ("position", "yaw", "velocity", "control")
"""The factors, in their order."""

_SIZE = len(WEIGHT_GROUPS)
_TRIED, _KEPT = slice(0, _SIZE), slice(_SIZE, 2 * _SIZE)  # Logarithms that are driven with, and that were found good.
_BEST, _RADIUS, _UPDATES = range(2 * _SIZE, 2 * _SIZE + 3)
_ENTRIES = 2 * _SIZE + 3  # Of the state, one row a place.
_GROUP_OF = np.zeros(STATE_SIZE + CONTROL_SIZE, dtype=int)
_GROUP_OF[StateIndex.YAW], _GROUP_OF[StateIndex.FORWARD_VELOCITY : STATE_SIZE], _GROUP_OF[STATE_SIZE:] = 1, 2, 3

_LEAST_SLOPE = 1e-9  # Cost by logarithm; a leg whose cost moves less with its weights says nothing about them.
_UNKNOWN = -1.0  # As a mismatch that was found with the kept factors: to be found out by the next leg.
_SHORTER, _LONGER = 0.5, 2.0  # Radius after a step that has not helped, by its length; after one that has, by itself.
_LEAST_TRUST = 1.0 / 256.0  # The least radius, by the first one.


class WeightEstimator(AbstractLearner):
    """Estimates factors of the controller's weights, starting at 1.

    Like other learners it holds settings only. What is learned is one vector. For each place it has the logarithms of
    the factors that are tried and of those that were kept, the size of the mismatch with the latter, the radius of the
    trust region and the number of updates.

    Attributes:
        places: names, in the order of the state.
    """

    def __init__(
        self,
        places: Sequence[str],
        *,
        gain: float = 0.5,
        trust_radius: float = 0.5,
        largest_factor: float = 4.0,
    ) -> None:
        """Constructs the estimator.

        Args:
            places: that legs lead to.
            gain: share of a Gauss-Newton step that is made, in (0, 1].
            trust_radius: of a step at most and at first, in the norm of the logarithms, > 0.
            largest_factor: factors lie between its inverse and it, > 1.

        Raises:
            BadInput: if a number is out of its range.
        """
        for name, value, good, expected in (
            ("gain", gain, 0.0 < gain <= 1.0, "a number in (0, 1]"),
            ("trust_radius", trust_radius, 0.0 < trust_radius < math.inf, "a finite number > 0"),
            ("largest_factor", largest_factor, 1.0 < largest_factor < math.inf, "a finite number > 1"),
        ):
            if not good:
                raise BadInput(name, str(value), expected)
        self.places = tuple(sorted(places))
        self._gain = gain
        self._trust_radius = trust_radius
        self._bound = math.log(largest_factor)

    def initial_state(self) -> FloatArray:
        """The state before any leg: (11 n,) for n places."""
        rows = np.zeros((len(self.places), _ENTRIES))
        rows[:, _BEST], rows[:, _RADIUS] = _UNKNOWN, self._trust_radius
        return rows.ravel()

    def update(self, state: FloatArray, place: str, mismatch: float, gradient: FloatArray) -> FloatArray:
        """The state after one leg to `place` with the factors of the state before; unchanged if it says nothing.

        Args:
            state: before; not modified.
            place: that the leg led to. One that is not known, and numbers that are not finite, teach nothing.
            mismatch: E^C, measured minus predicted cost.
            gradient: of the leg's cost by the logarithm of each diagonal entry of Q, then of R, shape (9,).
        """
        after = state.copy()
        if place not in self.places or not (math.isfinite(mismatch) and np.isfinite(gradient).all()):
            return after
        row = after.reshape(-1, _ENTRIES)[self.places.index(place)]
        slopes = np.bincount(_GROUP_OF, gradient, _SIZE)
        slopes -= slopes.mean()
        slope = float(np.linalg.norm(slopes))
        if slope < _LEAST_SLOPE:
            return after
        row[_UPDATES] += 1.0
        if row[_BEST] != _UNKNOWN:
            helped = abs(mismatch) < row[_BEST]
            row[_RADIUS] = self._next_radius(row, helped=helped)
            if not helped:
                row[_TRIED], row[_BEST] = row[_KEPT], _UNKNOWN
                return after
        row[_KEPT], row[_BEST] = row[_TRIED], abs(mismatch)
        wanted = self._gain * mismatch / slope
        step = max(-row[_RADIUS], min(wanted, row[_RADIUS]))
        row[_TRIED] = project_to_balanced_box(row[_KEPT] - step * slopes / slope, -self._bound, self._bound)
        return after

    def _next_radius(self, row: FloatArray, *, helped: bool) -> float:
        """The trust radius after the step of a place has been tried."""
        radius = float(row[_RADIUS])
        if helped:
            return min(_LONGER * radius, self._trust_radius)
        length, least = float(np.linalg.norm(row[_TRIED] - row[_KEPT])), _LEAST_TRUST * self._trust_radius
        return max(_SHORTER * length, least) if length > least else radius

    def factors(self, state: FloatArray, place: str) -> tuple[float, ...]:
        """The factors of a place, in the order of `WEIGHT_GROUPS`."""
        row = state.reshape(-1, _ENTRIES)[self.places.index(place)]
        return tuple(np.exp(row[_TRIED]).tolist())

    def updates(self, state: FloatArray, place: str) -> int:
        """The number of legs learned from that led to a place."""
        return int(state.reshape(-1, _ENTRIES)[self.places.index(place), _UPDATES])

    def learned(self, state: FloatArray) -> tuple[tuple[str, tuple[float, ...]], ...]:
        """The factors of the places that something was learned of."""
        return tuple((place, self.factors(state, place)) for place in self.places if self.updates(state, place))
