"""The triangular membership function."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from mala_drake.grounding.membership import AbstractMembership, FloatArray, require_increasing
from mala_drake.grounding.trapezoidal import Trapezoidal


@dataclass(frozen=True, slots=True)
class Triangular(AbstractMembership):
    """1 at `peak`, falling linearly to 0 at `left` and at `right`: a trapezoid whose top is one point.

    Raises:
        BadInput: unless left <= peak <= right, all finite.
    """

    left: float
    peak: float
    right: float

    def __post_init__(self) -> None:
        require_increasing("Triangular", left=self.left, peak=self.peak, right=self.right)

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """The membership at x."""
        return self._trapezoid().value(x)

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """The slope of the edge that x lies on, 0 outside."""
        return self._trapezoid().derivative(x)

    def _trapezoid(self) -> Trapezoidal:
        return Trapezoidal(self.left, self.peak, self.peak, self.right)
