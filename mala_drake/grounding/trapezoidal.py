"""The trapezoidal membership function."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.grounding.membership import AbstractMembership, FloatArray, require_increasing


@dataclass(frozen=True, slots=True)
class Trapezoidal(AbstractMembership):
    """0 outside (left, right), 1 on [left_top, right_top], linear between.

    An edge may be vertical (left == left_top): the top then belongs to the set, as in a crisp interval.

    Raises:
        BadInput: unless left <= left_top <= right_top <= right, all finite.
    """

    left: float
    left_top: float
    right_top: float
    right: float

    def __post_init__(self) -> None:
        require_increasing(
            "Trapezoidal", left=self.left, left_top=self.left_top, right_top=self.right_top, right=self.right
        )

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """The membership at x."""
        argument = np.asarray(x, dtype=float)
        rising, falling = self._edge_slopes()
        mu = np.where((self.left_top <= argument) & (argument <= self.right_top), 1.0, 0.0)
        mu = np.where((self.left < argument) & (argument < self.left_top), rising * (argument - self.left), mu)
        mu = np.where((self.right_top < argument) & (argument < self.right), falling * (argument - self.right), mu)
        return np.where(np.isnan(argument), np.nan, mu)

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """The slope of the edge that x lies on, 0 on the top and outside."""
        argument = np.asarray(x, dtype=float)
        rising, falling = self._edge_slopes()
        slope = np.where((self.left <= argument) & (argument < self.left_top), rising, 0.0)
        slope = np.where((self.right_top <= argument) & (argument < self.right), falling, slope)
        return np.where(np.isnan(argument), np.nan, slope)

    def _edge_slopes(self) -> tuple[float, float]:
        """The slopes of both edges; 0 for a vertical one, which no argument lies on."""
        rise, fall = self.left_top - self.left, self.right - self.right_top
        return (1.0 / rise if rise > 0.0 else 0.0), (-1.0 / fall if fall > 0.0 else 0.0)
