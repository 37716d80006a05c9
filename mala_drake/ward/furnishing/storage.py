"""Where items come from: furniture with a ledge from which the robot's arm takes things.

The lower part fills the whole footprint up to `LEDGE_HEIGHT`; above it the front, the face towards -y where the robot
stands, is set back by `LEDGE_DEPTH`, so that items stand on the ledge and the arm reaches over it.
"""

from __future__ import annotations

from mala_drake.ward.furnishing import palette
from mala_drake.ward.furnishing.palette import Color
from mala_drake.ward.furnishing.parts import Part, Size, box, cylinder

LEDGE_HEIGHT = 0.78
"""Of the surface on which items stand, metres above the floor."""

LEDGE_DEPTH = 0.28
"""From the front face to the upper part, metres."""

_PLATE = 0.03  # Thickness of boards, metres.
_PACKAGES = (palette.WHITE, palette.RED, (0.98, 0.85, 0.35), (0.40, 0.70, 0.90), (0.60, 0.80, 0.50))


def ledge_solids(size: Size) -> list[Part]:
    """The solid shape of furniture with a ledge: a full lower box and an upper box set back from the front."""
    length, width = size.half_length, size.half_width
    top = min(LEDGE_HEIGHT, size.height)
    parts = [box("lower", (-length, length), (-width, width), (0, top), None, solid=True)]
    if size.height > top:
        back = (-width + LEDGE_DEPTH, width)
        parts.append(box("upper", (-length, length), back, (top, size.height), None, solid=True))
    return parts


def base_unit(size: Size, body: Color, front: Color, *, doors: int = 3, top: Color = palette.WHITE) -> list[Part]:
    """The look of the lower part: a carcass with doors towards -y and a worktop at ledge height."""
    length, width = size.half_length, size.half_width
    parts = [
        box("plinth", (-length + 0.02, length - 0.02), (-width + 0.05, width), (0, 0.08), palette.DARK),
        box("carcass", (-length, length), (-width + 0.015, width), (0.08, LEDGE_HEIGHT - _PLATE), body),
        box("worktop", (-length, length), (-width, width), (LEDGE_HEIGHT - _PLATE, LEDGE_HEIGHT), top),
    ]
    step = 2 * length / doors
    for i in range(doors):
        left = -length + i * step
        across = (left + 0.02, left + step - 0.02)
        parts.append(box(f"door_{i}", across, (-width + 0.003, -width + 0.015), (0.11, LEDGE_HEIGHT - 0.06), front))
        middle = left + step / 2
        grip = (middle - 0.08, middle + 0.08)
        parts.append(
            box(f"grip_{i}", grip, (-width, -width + 0.003), (LEDGE_HEIGHT - 0.16, LEDGE_HEIGHT - 0.14), palette.DARK)
        )
    return parts


def _shelves(size: Size, frame: Color, board: Color, levels: int) -> tuple[list[Part], list[float]]:
    """The look of the upper part: back, sides, top and boards; also the heights of the boards' upper faces."""
    length, back, front = size.half_length, size.half_width, -size.half_width + LEDGE_DEPTH
    low, high = LEDGE_HEIGHT, size.height
    parts = [
        box("back", (-length, length), (back - _PLATE, back), (low, high), frame),
        box("side_left", (-length, -length + _PLATE), (front, back), (low, high), frame),
        box("side_right", (length - _PLATE, length), (front, back), (low, high), frame),
        box("top", (-length, length), (front, back), (high - _PLATE, high), frame),
    ]
    heights = [low]
    for i in range(1, levels):
        z = low + (high - low) * i / levels
        parts.append(box(f"board_{i}", (-length, length), (front + 0.02, back), (z, z + _PLATE), board))
        heights.append(z + _PLATE)
    return parts, heights


def pharmacy_cabinet(size: Size) -> list[Part]:
    """A dispensary: green doors, open shelves of packages, a green cross on the front and on the top."""
    green = palette.FUNCTION_COLORS["pharmacy"]
    length, front = size.half_length, -size.half_width + LEDGE_DEPTH
    parts, heights = _shelves(size, palette.WHITE, palette.WHITE, 3)
    count = max(2, round(2 * length / 0.3))
    step = (2 * length - 0.16) / count
    for level, z in enumerate(heights):
        for i in range(count):
            left = -length + 0.08 + i * step
            tall = 0.13 + 0.05 * ((3 * level + 2 * i) % 4)
            color = _PACKAGES[(level + 2 * i) % len(_PACKAGES)]
            across = (left + 0.02, left + step - 0.02)
            parts.append(box(f"package_{level}_{i}", across, (front + 0.06, front + 0.36), (z, z + tall), color))
    roof, middle = size.height, (front + size.half_width) / 2
    parts += [
        box("roof", (-length, length), (front, size.half_width), (roof, roof + 0.02), green),
        box("roof_cross_bar", (-0.36, 0.36), (middle - 0.12, middle + 0.12), (roof + 0.02, roof + 0.04), palette.WHITE),
        box(
            "roof_cross_pole", (-0.12, 0.12), (middle - 0.36, middle + 0.36), (roof + 0.02, roof + 0.041), palette.WHITE
        ),
        box("board", (-0.3, 0.3), (front, front + 0.02), (roof - 0.5, roof - 0.02), palette.WHITE),
        box("cross_bar", (-0.18, 0.18), (front - 0.01, front), (roof - 0.32, roof - 0.2), green),
        box("cross_pole", (-0.06, 0.06), (front - 0.011, front), (roof - 0.44, roof - 0.08), green),
    ]
    return ledge_solids(size) + base_unit(size, palette.WHITE, green) + parts


def supply_rack(size: Size) -> list[Part]:
    """A rack of blue posts and boards with cartons."""
    blue = palette.FUNCTION_COLORS["supply"]
    length, back, front = size.half_length, size.half_width, -size.half_width + LEDGE_DEPTH
    parts, heights = _shelves(size, blue, palette.STEEL, 3)
    count = max(2, round(2 * length / 0.45))
    step = (2 * length - 0.12) / count
    for level, z in enumerate(heights):
        for i in range(count):
            left = -length + 0.06 + i * step
            tall = 0.17 + 0.04 * ((level + i) % 3)
            carton = palette.CREAM if (level + i) % 2 else palette.WOOD
            across = (left + 0.03, left + step - 0.03)
            parts.append(box(f"carton_{level}_{i}", across, (front + 0.05, back - 0.08), (z, z + tall), carton))
            parts.append(box(f"tape_{level}_{i}", across, (front + 0.047, front + 0.05), (z + 0.06, z + 0.11), blue))
    return ledge_solids(size) + base_unit(size, palette.STEEL, blue, doors=2) + parts


def pantry_shelf(size: Size) -> list[Part]:
    """Wooden shelves of jars and loaves over an orange base unit."""
    orange = palette.FUNCTION_COLORS["kitchen"]
    length, front = size.half_length, -size.half_width + LEDGE_DEPTH
    parts, heights = _shelves(size, orange, palette.WOOD, 3)
    count = max(2, round(2 * length / 0.26))
    step = (2 * length - 0.12) / count
    for level, z in enumerate(heights):
        for i in range(count):
            x = -length + 0.06 + (i + 0.5) * step
            content = ((0.80, 0.30, 0.22), (0.88, 0.72, 0.40), (0.45, 0.62, 0.30), palette.CREAM)[(level + i) % 4]
            tall = 0.16 + 0.05 * ((level + 2 * i) % 3)
            parts.append(cylinder(f"jar_{level}_{i}", x, front + 0.15, (z, z + tall), 0.085, content))
            parts.append(
                cylinder(f"lid_{level}_{i}", x, front + 0.15, (z + tall, z + tall + 0.02), 0.07, palette.DARK_WOOD)
            )
    return ledge_solids(size) + base_unit(size, palette.WOOD, orange, top=palette.CREAM) + parts
