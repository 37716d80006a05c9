"""The truncated annulus: the paper's smooth membership of an `at` atom."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput
from mala_drake.grounding.membership import AbstractMembership, FloatArray, require_increasing, require_positive


@dataclass(frozen=True, slots=True)
class TruncatedAnnulus(AbstractMembership):
    """1 inside, a Gaussian skirt in the annulus, 0 outside (paper, Sec. "Integrating State representations").

    In the squared distance d^2: 1 up to `inner_squared`, exp(-(d^2 - inner_squared) / width^2) in the annulus, and 0
    from `outer_squared` on. The bounds are squared distances, as in the paper, while the argument is d >= 0 itself.
    The paper's formula counts the inner rim twice, as both indicators hold there, and its text puts the outer rim
    outside: the pieces here are [0, inner], (inner, outer) and [outer, infinity).

    The defaults share the ramp's radii of 1 and 5 m, and cross 0.7 where the ramp does, at 2.2 m.

    Raises:
        BadInput: unless 0 <= inner_squared < outer_squared and width > 0, all finite.
    """

    inner_squared: float = 1.0
    outer_squared: float = 25.0
    width: float = math.sqrt((2.2**2 - 1.0) / -math.log(0.7))

    def __post_init__(self) -> None:
        require_increasing(
            "TruncatedAnnulus", zero=0.0, inner_squared=self.inner_squared, outer_squared=self.outer_squared
        )
        if self.inner_squared == self.outer_squared:
            raise BadInput("TruncatedAnnulus.outer_squared", str(self.outer_squared), "more than inner_squared")
        require_positive("TruncatedAnnulus", width=self.width)

    def value(self, x: npt.ArrayLike) -> FloatArray:
        """The membership at the distance x."""
        squared = np.square(np.asarray(x, dtype=float))
        skirt = np.exp(-np.maximum(squared - self.inner_squared, 0.0) / self.width**2)
        return np.where(squared >= self.outer_squared, 0.0, skirt)

    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """-2 d / width^2 times the skirt in the annulus, 0 elsewhere."""
        distance = np.asarray(x, dtype=float)
        squared = np.square(distance)
        in_annulus = (self.inner_squared <= squared) & (squared < self.outer_squared)
        slope = np.where(in_annulus, -2.0 * distance / self.width**2, 0.0)
        return np.where(np.isnan(distance), np.nan, slope * self.value(distance))
