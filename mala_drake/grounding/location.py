"""The membership of being at a place: a function of the distance, over positions in the plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.grounding.membership import AbstractMembership, FloatArray, require_increasing
from mala_drake.grounding.saturated_ramp import SaturatedRamp

_PAPER_RAMP = SaturatedRamp()


@dataclass(frozen=True, slots=True)
class LocationMembership:
    """mu(p) = profile(||p - centre||), a fuzzy radial region (paper, Fig. "fuzzy radial region").

    Positions are arrays (..., 2) in metres. Gradients are arrays (..., 2) in 1/m; at the centre itself, where the
    direction is undefined, they are zero.

    Attributes:
        centre: (x, y), metres.
        profile: membership as a function of the distance.

    Raises:
        BadInput: if the centre is not finite.
    """

    centre: tuple[float, float]
    profile: AbstractMembership = _PAPER_RAMP

    def __post_init__(self) -> None:
        x, y = self.centre
        require_increasing("location", x=x)
        require_increasing("location", y=y)

    def distance(self, position: npt.ArrayLike) -> FloatArray:
        """The distance from the centre, (...), metres."""
        offset = np.asarray(position, dtype=float) - self.centre
        return np.asarray(np.sqrt((offset * offset).sum(axis=-1)))

    def value(self, position: npt.ArrayLike) -> FloatArray:
        """The membership, (...)."""
        return self.profile.value(self.distance(position))

    def gradient(self, position: npt.ArrayLike) -> FloatArray:
        """The derivative with respect to the position."""
        offset = np.asarray(position, dtype=float) - self.centre
        distance = np.sqrt((offset * offset).sum(axis=-1, keepdims=True))
        direction = np.divide(offset, distance, out=np.zeros_like(offset), where=distance > 0.0)
        return self.profile.derivative(distance) * direction
