"""Flat meshes: polygons and letters in the plane z = 0, as Wavefront OBJ text."""

from __future__ import annotations

import shapely
from shapely.geometry.base import BaseGeometry

_SMOOTHNESS = 0.012  # Of a letter's outline: the largest deviation, in font sizes.


def obj_text(region: BaseGeometry) -> str:
    """The triangles of a polygon or multipolygon, facing +z, with coordinates rounded to 0.1 mm."""
    indices: dict[tuple[float, float], int] = {}
    faces = []
    for triangle in shapely.constrained_delaunay_triangles(region).geoms:
        corners = shapely.orient_polygons(triangle, exterior_cw=False).exterior.coords[:3]
        rounded = ((round(x, 4) + 0.0, round(y, 4) + 0.0) for x, y in corners)
        faces.append([indices.setdefault(corner, len(indices) + 1) for corner in rounded])
    lines = [f"v {x:g} {y:g} 0" for x, y in indices]
    lines.append("vn 0 0 1")
    lines += ["f " + " ".join(f"{index}//1" for index in face) for face in faces]
    return "\n".join(lines) + "\n"


def lettering(lines: tuple[str, ...], *, size: float) -> shapely.MultiPolygon:
    """Lines of text centered on the origin, in a bold sans serif of font size `size` metres."""
    # Imported here because only the lettering of new signs needs it, and it takes a third of a second.
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    font = FontProperties(family="DejaVu Sans", weight="bold")
    region: BaseGeometry = shapely.MultiPolygon()
    for row, line in enumerate(lines):
        text: BaseGeometry = shapely.MultiPolygon()
        for loop in TextPath((0, 0), line, size=size, prop=font).to_polygons():
            # Inner loops (the hole of an "o") lie inside outer ones, and letters do not overlap.
            text = shapely.symmetric_difference(text, shapely.Polygon(loop).buffer(0))
        left, _, right, _ = text.bounds
        down = 1.2 * size * (row - (len(lines) - 1) / 2) + 0.36 * size
        region = shapely.union(
            region, shapely.transform(text, lambda points, x=(left + right) / 2, y=down: points - (x, y))
        )
    return shapely.MultiPolygon(shapely.get_parts(region.simplify(_SMOOTHNESS * size)).tolist())
