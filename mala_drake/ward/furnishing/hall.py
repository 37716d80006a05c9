"""What stands in halls and corridors: walls, desks, trolleys, plants, chairs and charging posts."""

from __future__ import annotations

from math import ceil

from mala_drake.ward.furnishing import palette
from mala_drake.ward.furnishing.palette import Color
from mala_drake.ward.furnishing.parts import Interval, Part, Size, box, cylinder, ellipsoid

_YELLOW = palette.FUNCTION_COLORS["charger"]
_TEAL = (0.20, 0.60, 0.62)


def _glazed(size: Size, *, sill: float, bay: float, base: Color, frame: Color) -> list[Part]:
    """A wall along its longer side: solid up to `sill`, glass in bays of about `bay` metres above."""
    along_x = size.half_length >= size.half_width
    reach, depth = (size.half_length, size.half_width) if along_x else (size.half_width, size.half_length)

    def piece(name: str, along: Interval, half_depth: float, z: Interval, color: Color) -> Part:
        through = (-half_depth, half_depth)
        return box(name, along, through, z, color) if along_x else box(name, through, along, z, color)

    top, rail = size.height, min(0.06, depth)
    parts = [
        box(
            "body",
            (-size.half_length, size.half_length),
            (-size.half_width, size.half_width),
            (0, top),
            None,
            solid=True,
        ),
        piece("sill", (-reach, reach), depth, (0, sill), base),
        piece("ledge", (-reach, reach), depth, (sill, sill + 0.03), frame),
        piece("glass", (-reach, reach), 0.25 * depth, (sill + 0.03, top - 0.05), palette.GLASS),
        piece("rail", (-reach, reach), rail, (top - 0.05, top), frame),
    ]
    count = max(1, ceil(2 * reach / bay))
    for i in range(count + 1):
        middle = -reach + rail + i * (2 * (reach - rail)) / count
        parts.append(piece(f"post_{i}", (middle - rail, middle + rail), rail, (sill + 0.03, top - 0.05), frame))
    return parts


def wall(size: Size) -> list[Part]:
    """An outer wall with a low sill and a band of windows, so that one sees the ward from outside."""
    return _glazed(size, sill=min(0.5, size.height / 2), bay=5.0, base=palette.CREAM, frame=palette.GRAY)


def partition(size: Size) -> list[Part]:
    """A thin inner wall, glazed in its upper half."""
    return _glazed(size, sill=min(0.9, size.height / 2), bay=1.6, base=(0.85, 0.89, 0.90), frame=palette.WHITE)


def reception_desk(size: Size) -> list[Part]:
    """A desk with a raised front towards -y, a screen and papers."""
    length, width, top = size.half_length, size.half_width, size.height
    return [
        box("body", (-length, length), (-width, width), (0, top), None, solid=True),
        box("table", (-length, length), (-width + 0.3, width), (0.08, 0.74), palette.CREAM),
        box("table_top", (-length, length), (-width + 0.3, width), (0.74, 0.78), palette.WOOD),
        box("front", (-length, length), (-width + 0.02, -width + 0.3), (0, top - 0.04), _TEAL),
        box("stripe", (-length, length), (-width, -width + 0.02), (0.55, 0.67), palette.WHITE),
        box("front_top", (-length, length), (-width, -width + 0.34), (top - 0.04, top), palette.WOOD),
        box("screen_foot", (-0.12, 0.12), (0.02, 0.16), (0.78, 0.8), palette.DARK),
        box("screen", (-0.3, 0.3), (0.06, 0.09), (0.84, 1.2), palette.DARK),
        box("screen_face", (-0.27, 0.27), (0.09, 0.095), (0.87, 1.17), palette.SCREEN),
        box("keyboard", (-0.22, 0.22), (0.22, 0.36), (0.78, 0.8), palette.DARK),
        box("papers", (0.5 * length, 0.5 * length + 0.3), (0.1, 0.36), (0.78, 0.82), palette.WHITE),
        cylinder("vase", -0.7 * length, -width + 0.16, (top, top + 0.15), 0.06, palette.WHITE),
        ellipsoid("flowers", (-0.7 * length, -width + 0.16, top + 0.24), (0.13, 0.13, 0.12), (0.92, 0.45, 0.60)),
    ]


def trolley(size: Size) -> list[Part]:
    """A parked trolley with folded linen on two decks."""
    length, width, top = size.half_length, size.half_width, size.height
    parts = [
        box("body", (-length, length), (-width, width), (0, top), None, solid=True),
        box("deck_low", (-length + 0.03, length - 0.03), (-width + 0.01, width - 0.01), (0.2, 0.24), palette.STEEL),
        box(
            "deck_high",
            (-length + 0.03, length - 0.03),
            (-width + 0.01, width - 0.01),
            (0.62 * top, 0.62 * top + 0.04),
            palette.STEEL,
        ),
        box("handle", (-length, -length + 0.03), (-width + 0.03, width - 0.03), (top - 0.04, top), palette.DARK),
    ]
    for i, (x, y) in enumerate(((-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0))):
        post_x, post_y = x * (length - 0.05), y * (width - 0.03)
        post = (0.1, top if x < 0 else 0.62 * top + 0.15)
        parts.append(
            box(f"post_{i}", (post_x - 0.015, post_x + 0.015), (post_y - 0.015, post_y + 0.015), post, palette.STEEL)
        )
        parts.append(ellipsoid(f"wheel_{i}", (post_x, post_y, 0.05), (0.05, 0.025, 0.05), palette.DARK))
    for i, (x, color) in enumerate(((-0.5, palette.WHITE), (0.0, palette.BLANKET), (0.5, palette.GOWN))):
        across = (x * length - 0.2 * length, x * length + 0.2 * length)
        parts.append(box(f"linen_low_{i}", across, (-0.7 * width, 0.7 * width), (0.24, 0.44), color))
        parts.append(
            box(f"linen_high_{i}", across, (-0.7 * width, 0.7 * width), (0.62 * top + 0.04, 0.62 * top + 0.16), color)
        )
    return parts


def planter(size: Size) -> list[Part]:
    """A round tub with a bush; its leaves stay inside the footprint."""
    radius, top = size.radius, size.height
    rim = 0.42 * top
    parts = [
        cylinder("body", 0, 0, (0, top), radius, None, solid=True),
        cylinder("tub", 0, 0, (0, rim), radius, palette.TERRACOTTA),
        cylinder("soil", 0, 0, (rim, rim + 0.01), 0.9 * radius, palette.DARK_WOOD),
        cylinder("stem", 0, 0, (rim, 0.8 * top), 0.12 * radius, palette.DARK_WOOD),
        ellipsoid("crown", (0, 0, 1.05 * top), (0.55 * radius, 0.55 * radius, 0.35 * top), palette.LEAF),
    ]
    for i, (x, y) in enumerate(((0.4, 0.1), (-0.2, 0.38), (-0.3, -0.3), (0.15, -0.42))):
        center = (x * radius, y * radius, (0.72 + 0.06 * i) * top)
        color = palette.LIGHT_LEAF if i % 2 else palette.LEAF
        parts.append(ellipsoid(f"leaves_{i}", center, (0.5 * radius, 0.5 * radius, 0.22 * top), color))
    return parts


def waiting_chairs(size: Size) -> list[Part]:
    """A row of chairs on a beam, backs towards +y."""
    length, width, top = size.half_length, size.half_width, size.height
    count = max(1, round(2 * length / 0.75))
    step = 2 * length / count
    parts = [
        box("body", (-length, length), (-width, width), (0, top), None, solid=True),
        box("beam", (-length, length), (-0.08, 0.08), (0.28, 0.36), palette.DARK),
        box("foot_left", (-0.8 * length, -0.8 * length + 0.08), (-width, width), (0, 0.05), palette.DARK),
        box("foot_right", (0.8 * length - 0.08, 0.8 * length), (-width, width), (0, 0.05), palette.DARK),
        box("leg_left", (-0.8 * length, -0.8 * length + 0.08), (-0.05, 0.05), (0.05, 0.28), palette.DARK),
        box("leg_right", (0.8 * length - 0.08, 0.8 * length), (-0.05, 0.05), (0.05, 0.28), palette.DARK),
    ]
    for i in range(count):
        across = (-length + i * step + 0.05, -length + (i + 1) * step - 0.05)
        parts.append(box(f"seat_{i}", across, (-width, 0.6 * width), (0.4, 0.46), _TEAL))
        parts.append(box(f"back_{i}", across, (0.6 * width, 0.8 * width), (0.42, top), _TEAL))
    return parts


def charging_post(size: Size) -> list[Part]:
    """A round yellow base with a post and a glowing sign of lightning."""
    radius, top = size.radius, size.height
    return [
        cylinder("body", 0, 0, (0, top), radius, None, solid=True),
        cylinder("base", 0, 0, (0, 0.12), radius, palette.DARK),
        cylinder("plate", 0, 0, (0.12, 0.16), 0.94 * radius, _YELLOW),
        cylinder("post", 0, 0, (0.16, top - 0.1), 0.36 * radius, palette.WHITE),
        cylinder("band", 0, 0, (0.55 * top, 0.75 * top), 0.38 * radius, _YELLOW),
        cylinder("glow", 0, 0, (top - 0.1, top - 0.04), 0.4 * radius, (0.55, 0.95, 0.60)),
        cylinder("head", 0, 0, (top - 0.04, top), 0.44 * radius, _YELLOW),
    ]
