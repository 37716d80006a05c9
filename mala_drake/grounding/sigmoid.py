"""The sigmoid membership function."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput
from mala_drake.grounding.membership import AbstractMembership, FloatArray, require_increasing


@dataclass(frozen=True, slots=True)
class Sigmoid(AbstractMembership):
    """1 / (1 + exp(-slope (x - centre))): rises through 0.5 at the centre, or falls if the slope is negative.

    Raises:
        BadInput: unless the centre and the slope are finite and the slope is not 0.
    """

    centre: float
    slope: float

    def __post_init__(self) -> None:
        require_increasing("Sigmoid", centre=self.centre)
        require_increasing("Sigmoid", slope=self.slope)
        if self.slope == 0.0:
            raise BadInput("Sigmoid.slope", "0", "a finite number other than 0")

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """The membership at x."""
        # The hyperbolic tangent saturates where the exponential would overflow.
        return 0.5 * (1.0 + np.tanh(0.5 * self.slope * (np.asarray(x, dtype=float) - self.centre)))

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """Equal to slope mu (1 - mu)."""
        half = 0.5 * np.tanh(0.5 * self.slope * (np.asarray(x, dtype=float) - self.centre))
        return self.slope * (0.25 - np.square(half))
