"""Kitchen furniture: cooling, preparing, cooking and tasting; all with the ledge of `storage`."""

from __future__ import annotations

from mala_drake.ward.furnishing import palette
from mala_drake.ward.furnishing.parts import Part, Size, box, cylinder, ellipsoid
from mala_drake.ward.furnishing.storage import LEDGE_DEPTH, LEDGE_HEIGHT, base_unit, ledge_solids

_ORANGE = palette.FUNCTION_COLORS["kitchen"]


def _backboard(size: Size) -> list[Part]:
    """What is left of the upper part of a low counter: a deck behind the ledge."""
    if size.height <= LEDGE_HEIGHT:
        return []
    behind = (-size.half_width + LEDGE_DEPTH, size.half_width)
    length = size.half_length
    return [
        box("deck", (-length, length), behind, (LEDGE_HEIGHT, size.height - 0.03), _ORANGE),
        box("deck_top", (-length, length), behind, (size.height - 0.03, size.height), palette.CREAM),
    ]


def fridge(size: Size) -> list[Part]:
    """A steel fridge whose freezer drawer carries the ledge; it hums and holds the chicken."""
    length, back, front = size.half_length, size.half_width, -size.half_width + LEDGE_DEPTH
    parts = [
        box("body", (-length, length), (front + 0.02, back), (LEDGE_HEIGHT, size.height), palette.STEEL),
        box("lid", (-length, length), (front, back), (size.height, size.height + 0.02), _ORANGE),
        box(
            "left_door",
            (-length + 0.01, -0.01),
            (front, front + 0.02),
            (LEDGE_HEIGHT + 0.03, size.height - 0.02),
            palette.WHITE,
        ),
        box(
            "right_door",
            (0.01, length - 0.01),
            (front, front + 0.02),
            (LEDGE_HEIGHT + 0.03, size.height - 0.02),
            palette.WHITE,
        ),
        box("left_grip", (-0.07, -0.04), (front - 0.03, front), (LEDGE_HEIGHT + 0.2, size.height - 0.3), palette.DARK),
        box("right_grip", (0.04, 0.07), (front - 0.03, front), (LEDGE_HEIGHT + 0.2, size.height - 0.3), palette.DARK),
        box("display", (0.12, 0.3), (front - 0.005, front), (size.height - 0.3, size.height - 0.2), palette.SCREEN),
    ]
    return ledge_solids(size) + base_unit(size, palette.STEEL, palette.WHITE, doors=1, top=palette.STEEL) + parts


def kitchen_counter(size: Size) -> list[Part]:
    """A preparation counter with a sink, a tap and a chopping board."""
    length, back, deck = size.half_length, size.half_width, max(size.height, LEDGE_HEIGHT)
    parts = [
        box("sink", (-0.8 * length, -0.15 * length), (back - 0.6, back - 0.2), (deck, deck + 0.008), palette.STEEL),
        box(
            "bowl",
            (-0.72 * length, -0.23 * length),
            (back - 0.55, back - 0.25),
            (deck + 0.008, deck + 0.012),
            palette.GRAY,
        ),
        cylinder("tap", -0.47 * length, back - 0.12, (deck, deck + 0.3), 0.02, palette.STEEL),
        box(
            "spout",
            (-0.49 * length, -0.45 * length),
            (back - 0.3, back - 0.1),
            (deck + 0.28, deck + 0.31),
            palette.STEEL,
        ),
        box(
            "chopping_board",
            (0.15 * length, 0.75 * length),
            (back - 0.6, back - 0.25),
            (deck, deck + 0.025),
            palette.WOOD,
        ),
        ellipsoid("tomato", (0.3 * length, back - 0.4, deck + 0.06), (0.05, 0.05, 0.045), palette.RED),
        ellipsoid("lettuce", (0.55 * length, back - 0.42, deck + 0.08), (0.09, 0.08, 0.07), palette.LIGHT_LEAF),
    ]
    return ledge_solids(size) + base_unit(size, palette.CREAM, _ORANGE) + _backboard(size) + parts


def stove(size: Size) -> list[Part]:
    """A stove: oven door towards the robot, four plates on the deck, a steaming pot on one of them."""
    length, width, deck = size.half_length, size.half_width, max(size.height, LEDGE_HEIGHT)
    middle = LEDGE_DEPTH / 2
    parts = [
        box(
            "hob",
            (-0.92 * length, 0.92 * length),
            (-width + LEDGE_DEPTH + 0.03, width - 0.04),
            (deck, deck + 0.01),
            palette.DARK,
        ),
        box("oven", (-0.75 * length, 0.75 * length), (-width, -width + 0.01), (0.2, 0.58), palette.DARK),
        box("window", (-0.55 * length, 0.55 * length), (-width - 0.0, -width + 0.002), (0.28, 0.5), (0.95, 0.60, 0.25)),
        cylinder("pot", 0.45 * length, middle + 0.42 * width, (deck + 0.02, deck + 0.2), 0.13, palette.STEEL),
        cylinder("soup", 0.45 * length, middle + 0.42 * width, (deck + 0.2, deck + 0.205), 0.115, (0.90, 0.55, 0.20)),
    ]
    for i, (x, y) in enumerate(((-0.45, -0.38), (0.45, -0.38), (-0.45, 0.42), (0.45, 0.42))):
        color = palette.RED if i == 3 else palette.GRAY
        parts.append(cylinder(f"plate_{i}", x * length, middle + y * width, (deck + 0.01, deck + 0.02), 0.15, color))
    return (
        ledge_solids(size)
        + base_unit(size, palette.STEEL, palette.STEEL, doors=1, top=palette.STEEL)
        + _backboard(size)
        + parts
    )


def quality_counter(size: Size) -> list[Part]:
    """A tasting counter: a plate under a cloche and a tablet to note the verdict."""
    length, deck = size.half_length, max(size.height, LEDGE_HEIGHT)
    y = LEDGE_DEPTH / 2
    parts = [
        cylinder("plate", -0.4 * length, y, (deck, deck + 0.015), 0.17, palette.WHITE),
        ellipsoid("cloche", (-0.4 * length, y, deck + 0.02), (0.14, 0.14, 0.13), palette.STEEL),
        ellipsoid("knob", (-0.4 * length, y, deck + 0.16), (0.025, 0.025, 0.025), palette.DARK),
        box("tablet", (0.2 * length, 0.8 * length), (y - 0.12, y + 0.12), (deck, deck + 0.02), palette.DARK),
        box("verdict", (0.23 * length, 0.77 * length), (y - 0.1, y + 0.1), (deck + 0.02, deck + 0.022), palette.SCREEN),
    ]
    return ledge_solids(size) + base_unit(size, palette.CREAM, _ORANGE, doors=2) + _backboard(size) + parts
