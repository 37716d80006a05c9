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
        # Clipping first keeps the quotients within [0, 1] however steep the edges are.
        mu = np.where((self.left <= argument) & (argument <= self.right), 1.0, 0.0)
        if self.left < self.left_top:
            rising = (np.clip(argument, self.left, self.left_top) - self.left) / (self.left_top - self.left)
            mu = np.minimum(mu, rising)
        if self.right_top < self.right:
            falling = (self.right - np.clip(argument, self.right_top, self.right)) / (self.right - self.right_top)
            mu = np.minimum(mu, falling)
        return np.where(np.isnan(argument), np.nan, mu)

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """The slope of the edge that x lies on, 0 on the top and outside."""
        argument = np.asarray(x, dtype=float)
        slope = np.zeros_like(argument)
        if self.left < self.left_top:
            on_edge = (self.left <= argument) & (argument < self.left_top)
            slope = np.where(on_edge, 1.0 / (self.left_top - self.left), slope)
        if self.right_top < self.right:
            on_edge = (self.right_top <= argument) & (argument < self.right)
            slope = np.where(on_edge, -1.0 / (self.right - self.right_top), slope)
        return np.where(np.isnan(argument), np.nan, slope)
