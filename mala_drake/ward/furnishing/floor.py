"""The floor: solid everywhere, tinted by congestion level where the map has zones."""

from __future__ import annotations

from collections.abc import Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from mala_drake.ward.furnishing.palette import floor_color
from mala_drake.ward.furnishing.parts import Part, box, mesh
from mala_drake.ward.ward_map import Zone

_THICKNESS = 1.0  # Of the solid floor, metres.
_TILE = 2.5  # Side of a tile, metres.
_DARKER = 0.975  # Brightness of dark tiles relative to light ones.


def floor_regions(half_extent: float, zones: Sequence[Zone]) -> list[tuple[float, BaseGeometry]]:
    """Level and region: a partition of the floor. Where zones overlap the highest level counts; level 0 is the rest."""
    rest: BaseGeometry = shapely.box(-half_extent, -half_extent, half_extent, half_extent)
    regions = []
    for level in sorted({zone.level for zone in zones}, reverse=True):
        wanted = shapely.union_all([shapely.Polygon(zone.polygon) for zone in zones if zone.level == level])
        region = shapely.intersection(rest, wanted)
        rest = shapely.difference(rest, wanted)
        if not region.is_empty:
            regions.append((level, region))
    return [*regions, (0.0, rest)]


def floor_tiles(region: BaseGeometry) -> tuple[BaseGeometry, BaseGeometry]:
    """The region's light and dark tiles, a checkerboard that gives the eye a scale."""
    left, bottom, right, top = (round(bound / _TILE) for bound in region.bounds)
    squares = [
        shapely.box(_TILE * i, _TILE * j, _TILE * (i + 1), _TILE * (j + 1))
        for i in range(left - 1, right + 1)
        for j in range(bottom - 1, top + 1)
        if (i + j) % 2
    ]
    dark = shapely.intersection(region, shapely.MultiPolygon(squares))
    return shapely.difference(region, dark), dark


def floor_parts(half_extent: float, levels: Sequence[float], uris: Sequence[tuple[str, str]]) -> list[Part]:
    """A thick solid slab whose upper face is z = 0, and two flat meshes a level, of light and of dark tiles.

    It is no half space because FCL's tree of moving geometries, where a welded body's are before the plant is final,
    cannot hold one: it crashes at about the twentieth geometry.
    """
    extent = (-half_extent, half_extent)
    parts = [box("ground", extent, extent, (-_THICKNESS, 0.0), None, solid=True)]
    for level, (light, dark) in zip(levels, uris, strict=True):
        red, green, blue = floor_color(level)
        parts.append(mesh(f"level_{level:g}_light", light, (red, green, blue)))
        parts.append(mesh(f"level_{level:g}_dark", dark, (_DARKER * red, _DARKER * green, _DARKER * blue)))
    return parts


def standing_mark() -> BaseGeometry:
    """A ring where the robot stands, with a chevron in front of it that tells the heading, along x."""
    ring = shapely.difference(shapely.Point(0, 0).buffer(0.42), shapely.Point(0, 0).buffer(0.34))
    chevron = shapely.Polygon([(0.48, -0.14), (0.62, 0.0), (0.48, 0.14), (0.56, 0.14), (0.70, 0.0), (0.56, -0.14)])
    return shapely.union(ring, chevron)
