"""Which place the robot is at: l_fuzzy, the best place if it is good enough, else in transit."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput
from mala_drake.grounding.defuzzification import INSTANTIATION_THRESHOLD, ArgmaxThreshold
from mala_drake.grounding.location import LocationMembership
from mala_drake.grounding.membership import AbstractMembership, FloatArray
from mala_drake.grounding.saturated_ramp import SaturatedRamp

IN_TRANSIT = ""

_PAPER_RAMP = SaturatedRamp()


class LocationGrounding:
    """Memberships of named places and the place they say the robot is at (paper, Sec. "Fuzzy State Estimation")."""

    def __init__(
        self,
        locations: Mapping[str, tuple[float, float]],
        *,
        membership: AbstractMembership = _PAPER_RAMP,
        threshold: float = INSTANTIATION_THRESHOLD,
    ) -> None:
        """Constructs the grounding.

        Args:
            locations: centre (x, y) of each place, metres, by name. Their order does not matter.
            membership: as a function of the distance in metres.
            threshold: degree in (0, 1] from which the robot counts as being there.

        Raises:
            BadInput: if a name is empty, a centre not finite or the threshold out of range.
        """
        if IN_TRANSIT in locations:
            raise BadInput("locations", "a place without a name", "a name")
        self.places = tuple(sorted(locations))
        self.membership = membership
        self._argmax = ArgmaxThreshold(threshold)
        self._locations = {name: LocationMembership(locations[name], membership) for name in self.places}
        self._centres = np.array([location.centre for location in self._locations.values()]).reshape(-1, 2)

    def values(self, position: npt.ArrayLike) -> FloatArray:
        """The membership of each of `places` at the position (2,), metres: (L,)."""
        distances = np.linalg.norm(self._centres - np.asarray(position, dtype=float), axis=-1)
        return self.membership.value(distances)

    def location(self, place: str) -> LocationMembership:
        """The membership of one place, with its gradients."""
        return self._locations[place]

    def place(self, values: npt.ArrayLike, *, expected: str = IN_TRANSIT) -> str:
        """The place l_fuzzy, or IN_TRANSIT when the highest membership is below the threshold.

        Args:
            values: memberships of `places`, (L,).
            expected: the place the planner expects. Among equally high memberships it wins, because a robot that is
                fully there contradicts nobody; otherwise the first name in the alphabet does.
        """
        degrees = np.asarray(values, dtype=float)
        chosen = np.flatnonzero(self._argmax.crisp(degrees))
        if chosen.size == 0:
            return IN_TRANSIT
        best = int(chosen[0])
        if expected in self.places and degrees[self.places.index(expected)] == degrees[best]:
            return expected
        return self.places[best]
