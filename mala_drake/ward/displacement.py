"""A ward in which some places are not where the map says: their furniture was moved, and they with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from mala_drake.errors import BadInput
from mala_drake.ward.ward_map import Ward

Displacement = tuple[float, float]
"""(dx, dy), metres."""


def displaced_ward(ward: Ward, displacements: Mapping[str, Displacement]) -> Ward:
    """The ward as it really is.

    Places and the furniture that serves them are moved without being turned, so that each place has its furniture in
    front of it as before; all else stays. A ward without displacements is returned as it is.

    Args:
        ward: the map.
        displacements: by place.

    Raises:
        BadInput: for a place that is not on the map.
    """
    if not displacements:
        return ward
    for name in displacements:
        if name not in ward.place:
            raise BadInput("displaced place", repr(name), "one of " + ", ".join(ward.place))
    none = (0.0, 0.0)
    places, furniture = [], []
    for place in ward.places:
        dx, dy = displacements.get(place.name, none)
        places.append(replace(place, x=place.x + dx, y=place.y + dy))
    for piece in ward.furniture:
        dx, dy = displacements.get(piece.serves, none)
        furniture.append(replace(piece, x=piece.x + dx, y=piece.y + dy))
    return replace(ward, places=tuple(places), furniture=tuple(furniture))
