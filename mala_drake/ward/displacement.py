"""A ward in which some places are not where the map says: their furniture was moved, and they with it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from mala_drake.errors import BadInput
from mala_drake.messages import Shape
from mala_drake.ward.routes import GOAL_DISTANCE
from mala_drake.ward.shapes import ShapeDistances, outline
from mala_drake.ward.ward_map import Place, Ward

Displacement = tuple[float, float]
"""(dx, dy), metres."""

DRAWN_DISTANCES = (1.5, 4.0)
"""Metres from the map at least and at most of a displacement that is drawn (facts of the paper's experiment)."""

_FURNITURE_GAP = 0.1  # Metres.
_DRAWS = 1000  # Of one displacement, before it is given up.


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


def taken_place(
    ward: Ward, displacements: Mapping[str, Displacement], unmapped: Iterable[Shape] = ()
) -> tuple[Place, Shape] | None:
    """A place at which the robot or its furniture cannot stand, and what stands there; None if there is no such place.

    The robot has to fit wherever a place is and wherever the map says it is, both by the map and really. Displaced
    furniture keeps clear of everything else that is solid: boxes stand at its edge.

    Args:
        ward: the map.
        displacements: by place.
        unmapped: what else stands in the ward.
    """
    true_ward = displaced_ward(ward, displacements)
    solid = (*ward.shapes, *true_ward.shapes, *unmapped)
    distances = ShapeDistances(solid)
    for place in (*true_ward.places, *(ward.place[name] for name in displacements)):
        gaps = distances([place.x, place.y])
        if max(abs(place.x), abs(place.y)) >= ward.half_extent or gaps.min() < GOAL_DISTANCE:
            return place, solid[int(gaps.argmin())]
    for name in displacements:
        piece = true_ward.furniture_of.get(name)
        if piece is None:
            continue
        ground = outline(piece.shape, margin=_FURNITURE_GAP)
        for other in (*true_ward.shapes, *unmapped):
            if other.name != piece.name and ground.intersects(outline(other)):
                return true_ward.place[name], other
    return None


def draw_displacements(
    ward: Ward,
    places: Iterable[str],
    generator: np.random.Generator,
    unmapped: Iterable[Shape] = (),
    told: Mapping[str, Displacement] | None = None,
) -> dict[str, Displacement]:
    """Displacements evenly distributed over distance and direction, such that the robot can stand at every place.

    Args:
        ward: the map.
        places: to be displaced, one after the other.
        generator: that draws.
        unmapped: what else stands in the ward.
        told: displacements that there are besides; they come first in what is returned.

    Raises:
        BadInput: for a place that is not on the map, or that cannot be displaced.
    """
    found: dict[str, Displacement] = dict(told or {})
    unmapped = tuple(unmapped)
    for name in places:
        for _ in range(_DRAWS):
            distance, angle = generator.uniform(*DRAWN_DISTANCES), generator.uniform(0.0, math.tau)
            candidate = found | {name: (float(distance * np.cos(angle)), float(distance * np.sin(angle)))}
            if taken_place(ward, candidate, unmapped) is None:
                found = candidate
                break
        else:
            raise BadInput("displaced place", repr(name), "room for it and its furniture elsewhere")
    return found
