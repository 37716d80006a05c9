"""From what matters to the patient to what costs the controller: Q(w) and R(w), affine in the preference weights.

Each diagonal entry is its working-point value times 1 + sum_i gain_i (w_i - 1/5), so that uniform weights give the
working point. Position errors cost more when time matters (lagging behind is time lost), velocity errors when safety
and proximity matter, orientation errors when the approach matters, and control effort when the battery matters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.errors import BadInput
from mala_drake.messages import LearnedWeights
from mala_drake.preferences import CRITERIA

from .model import CONTROL_SIZE, STATE_SIZE
from .parameters import CONTROL_WEIGHTS, STATE_WEIGHTS

FEATURES = CRITERIA
"""Order of the preference weights."""

_SIMPLEX_TOLERANCE = 1e-6

_POSITION = (2.0, 0.0, 0.0, 0.0, 0.0)
_ORIENTATION = (0.0, 0.0, 0.0, 0.0, 3.0)
_VELOCITY = (0.0, 2.0, 0.0, 2.0, 0.0)
_EFFORT = (0.0, 0.0, 3.0, 0.0, 0.0)


@dataclass(frozen=True)
class CostTranslation:
    """The affine map as data: relative gains, one row a diagonal entry and one column a preference weight.

    Whatever the gains (they may be learned), an entry stays within `LOWEST` and `HIGHEST` times its working point, so
    that the stage cost stays positive definite. The default gains stay inside these bounds on the whole simplex.
    """

    LOWEST: ClassVar[float] = 0.1
    HIGHEST: ClassVar[float] = 4.0

    state_gains: tuple[tuple[float, ...], ...] = (_POSITION,) * 2 + (_ORIENTATION,) + (_VELOCITY,) * 3  # 6 x 5.
    control_gains: tuple[tuple[float, ...], ...] = (_EFFORT,) * CONTROL_SIZE  # 3 x 5.

    def __post_init__(self) -> None:
        for name, rows in (("state_gains", STATE_SIZE), ("control_gains", CONTROL_SIZE)):
            gains = np.array(getattr(self, name), dtype=float)
            if gains.shape != (rows, len(FEATURES)) or not np.isfinite(gains).all():
                raise BadInput(f"CostTranslation.{name}", f"shape {gains.shape}", f"a finite {rows} x 5 matrix")

    def __call__(self, weights: Sequence[float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The diagonals of Q, shape (6,), and R, shape (3,), for preference weights on the simplex.

        Raises:
            BadInput: the weights are not five non-negative numbers that sum to one.
        """
        excess = _excess(weights)
        return self._entries(STATE_WEIGHTS, self.state_gains, excess), self._entries(
            CONTROL_WEIGHTS, self.control_gains, excess
        )

    @property
    def gains(self) -> NDArray[np.float64]:
        """All gains, shape (9, 5): the rows of Q's diagonal, then those of R's."""
        return np.array((*self.state_gains, *self.control_gains))

    @classmethod
    def of(cls, gains: ArrayLike) -> CostTranslation:
        """The translation with these `gains`, shape (9, 5)."""
        rows = [tuple(map(float, row)) for row in np.asarray(gains)]
        return cls(tuple(rows[:STATE_SIZE]), tuple(rows[STATE_SIZE:]))

    def log_gradient(self, weights: Sequence[float]) -> NDArray[np.float64]:
        """The derivative of the logarithm of each diagonal entry by the gains of its own row, shape (9, 5).

        An entry at a bound does not move with its gains.

        Raises:
            BadInput: as for the translation.
        """
        excess = _excess(weights)
        factors = 1.0 + self.gains @ excess
        inside = (factors > self.LOWEST) & (factors < self.HIGHEST)
        return np.where(inside, 1.0 / factors, 0.0)[:, None] * excess

    def _entries(self, working_point: ArrayLike, gains: ArrayLike, excess: NDArray[np.float64]) -> NDArray[np.float64]:
        factors = np.clip(1.0 + np.asarray(gains) @ excess, self.LOWEST, self.HIGHEST)
        return np.asarray(working_point) * factors


DEFAULT_TRANSLATION = CostTranslation()


def learned_translation(learned: LearnedWeights) -> CostTranslation:
    """The translation as it was learned, or the default one while none is."""
    return CostTranslation.of(learned.gains) if learned.gains else DEFAULT_TRANSLATION


def _excess(weights: Sequence[float]) -> NDArray[np.float64]:
    """By how much each preference is above the uniform ones."""
    return _checked(weights) - 1.0 / len(FEATURES)


def _checked(weights: Sequence[float]) -> NDArray[np.float64]:
    vector = np.asarray(weights, dtype=float)
    on_simplex = (
        vector.shape == (len(FEATURES),)
        and np.isfinite(vector).all()
        and (vector >= -_SIMPLEX_TOLERANCE).all()
        and abs(vector.sum() - 1.0) <= _SIMPLEX_TOLERANCE
    )
    if not on_simplex:
        raise BadInput("preference weights", str(vector), "five non-negative numbers that sum to one")
    return vector
