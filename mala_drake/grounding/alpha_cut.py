"""The alpha-cut of a fuzzy set: the crisp set of what belongs to it well enough."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput
from mala_drake.grounding.defuzzification import INSTANTIATION_THRESHOLD
from mala_drake.grounding.membership import AbstractMembership, FloatArray


@dataclass(frozen=True, slots=True)
class AlphaCut(AbstractMembership):
    """1 where another membership is at least `level`, 0 elsewhere: degrees of truth given up.

    Attributes:
        membership: that is cut.
        level: alpha, in (0, 1]; by default the degree from which atoms hold (paper, Sec. "Fuzzy State Estimation"), so
            that the same atoms hold with and without degrees, except where two crisp sets overlap.

    Raises:
        BadInput: if the level is not in (0, 1].
    """

    membership: AbstractMembership
    level: float = INSTANTIATION_THRESHOLD

    def __post_init__(self) -> None:
        if not 0.0 < self.level <= 1.0:
            raise BadInput("AlphaCut.level", str(self.level), "a number in (0, 1]")

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """The membership at x; NaN of NaN."""
        degree = self.membership.value(x)
        return np.where(np.isnan(degree), np.nan, np.where(degree >= self.level, 1.0, 0.0))

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """0 on both sides of the cut: a crisp set tells nobody which way to go."""
        degree = self.membership.value(x)
        return np.where(np.isnan(degree), np.nan, 0.0)
