"""The floor: solid everywhere, tinted by congestion level where the map has zones."""

from __future__ import annotations

from collections.abc import Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from mala_drake.ward.furnishing.palette import floor_color
from mala_drake.ward.furnishing.parts import Part, box, mesh
from mala_drake.ward.ward_map import Zone

_THICKNESS = 1.0  # Of the solid floor, metres.


def floor_regions(half_extent: float, zones: Sequence[Zone]) -> list[tuple[float, BaseGeometry]]:
    """Level and region, a partition of the floor: where zones overlap, the highest level counts; level 0 is the rest."""
    rest: BaseGeometry = shapely.box(-half_extent, -half_extent, half_extent, half_extent)
    regions = []
    for level in sorted({zone.level for zone in zones}, reverse=True):
        wanted = shapely.union_all([shapely.Polygon(zone.polygon) for zone in zones if zone.level == level])
        region = shapely.intersection(rest, wanted)
        rest = shapely.difference(rest, wanted)
        if not region.is_empty:
            regions.append((level, region))
    return [*regions, (0.0, rest)]


def floor_parts(half_extent: float, levels: Sequence[float], uris: Sequence[str]) -> list[Part]:
    """A thick solid slab whose upper face is z = 0, and one flat mesh a level.

    It is no half space because FCL's tree of moving geometries, where a welded body's are before the plant is final,
    cannot hold one: it crashes at about the twentieth geometry.
    """
    extent = (-half_extent, half_extent)
    looks = [mesh(f"level_{level:g}", uri, floor_color(level)) for level, uri in zip(levels, uris, strict=True)]
    return [box("ground", extent, extent, (-_THICKNESS, 0.0), None, solid=True), *looks]
