"""The saturated ramp: the paper's membership of a location."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput
from mala_drake.grounding.membership import AbstractMembership, FloatArray, require_increasing


@dataclass(frozen=True, slots=True)
class SaturatedRamp(AbstractMembership):
    """1 up to `full`, falling linearly to 0 at `zero` and 0 beyond (paper, Sec. "Fuzzy State Estimation").

    The defaults are the paper's, for a distance in metres: mu = 1 for d <= 1, (5 - d) / 4 between, 0 for d >= 5.

    Raises:
        BadInput: unless full < zero, both finite.
    """

    full: float = 1.0
    zero: float = 5.0

    def __post_init__(self) -> None:
        require_increasing("SaturatedRamp", full=self.full, zero=self.zero)
        if self.full == self.zero:
            raise BadInput("SaturatedRamp.zero", str(self.zero), f"more than full = {self.full}")

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """The membership at x."""
        return (self.zero - np.clip(np.asarray(x, dtype=float), self.full, self.zero)) / (self.zero - self.full)

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """-1 / (zero - full) on the slope, 0 on both plateaus."""
        argument = np.asarray(x, dtype=float)
        on_slope = (self.full <= argument) & (argument < self.zero)
        slope = np.where(on_slope, -1.0 / (self.zero - self.full), 0.0)
        return np.where(np.isnan(argument), np.nan, slope)
