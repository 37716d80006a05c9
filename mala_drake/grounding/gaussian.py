"""The Gaussian membership function."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.grounding.membership import AbstractMembership, FloatArray, require_increasing, require_positive


@dataclass(frozen=True, slots=True)
class Gaussian(AbstractMembership):
    """exp(-(x - centre)^2 / (2 deviation^2)).

    Raises:
        BadInput: unless the centre is finite and the deviation finite and positive.
    """

    centre: float
    deviation: float

    def __post_init__(self) -> None:
        require_increasing("Gaussian", centre=self.centre)
        require_positive("Gaussian", deviation=self.deviation)

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """The membership at x."""
        return np.exp(-0.5 * np.square((np.asarray(x, dtype=float) - self.centre) / self.deviation))

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """-(x - centre) / deviation^2 times the membership."""
        argument = np.asarray(x, dtype=float)
        return -(argument - self.centre) / self.deviation**2 * self.value(argument)
