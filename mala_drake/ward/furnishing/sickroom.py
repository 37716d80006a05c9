"""The patient's room: bed with the patient in it, bedside tables and the privacy screen."""

from __future__ import annotations

from math import pi

from mala_drake.ward.furnishing import palette
from mala_drake.ward.furnishing.parts import Part, Size, box, capsule, cylinder, ellipsoid

_PINK = palette.FUNCTION_COLORS["bedside"]
_STEP = 0.16  # Height of the step on which the bed stands, metres.
_MATTRESS = 0.72  # Height of the mattress' upper face, metres.


def bed(size: Size) -> list[Part]:
    """A hospital bed on a step that fills the footprint, head towards +y, with a patient under the blanket."""
    length, width = size.half_length, size.half_width
    across = (-0.62 * length, 0.62 * length)
    head, foot = 0.93 * width, -0.42 * width
    parts = [
        box("step", (-length, length), (-width, width), (0, _STEP), palette.WOOD, solid=True),
        box(
            "carpet",
            (-0.95 * length, 0.95 * length),
            (-0.97 * width, 0.97 * width),
            (_STEP, _STEP + 0.006),
            (0.93, 0.80, 0.84),
        ),
        box("body", across, (foot, head), (0, _MATTRESS), None, solid=True),
        box("frame", across, (foot, head), (0.38, 0.5), palette.STEEL),
        box("motor", (-0.3, 0.3), (foot + 0.5, head - 0.5), (_STEP, 0.38), palette.DARK),
        box(
            "mattress",
            (across[0] + 0.03, across[1] - 0.03),
            (foot + 0.04, head - 0.03),
            (0.5, _MATTRESS),
            palette.WHITE,
        ),
        box("headboard", across, (head, head + 0.06), (0.3, max(1.1 * size.height, 0.9)), _PINK),
        box("footboard", across, (foot - 0.06, foot), (0.3, 0.9), _PINK),
    ]
    return parts + _rails(across, foot, head) + _patient(head, foot, across[1]) + _equipment(size, head)


def _rails(across: tuple[float, float], foot: float, head: float) -> list[Part]:
    parts = []
    spans = ((foot + 0.25, (foot + head) / 2 - 0.15), ((foot + head) / 2 + 0.15, head - 0.3))
    for side, x in (("left", across[0] - 0.025), ("right", across[1] + 0.025)):
        for i, span in enumerate(spans):
            for level, z in enumerate((0.68, 0.79, 0.90)):
                parts.append(
                    box(f"rail_{side}_{i}_{level}", (x - 0.015, x + 0.015), span, (z, z + 0.035), palette.STEEL)
                )
            for end, y in enumerate(span):
                upright = (y - 0.02, y + 0.02)
                parts.append(
                    box(f"rail_post_{side}_{i}_{end}", (x - 0.016, x + 0.016), upright, (0.45, 0.935), palette.STEEL)
                )
    return parts


def _patient(head: float, foot: float, reach: float) -> list[Part]:
    """Somebody lying on the back: head on the pillow, arms on the blanket. Larger than life, to be seen from afar."""
    z, y = _MATTRESS, head - 0.45
    chest = y - 0.75
    blanket = (foot + 0.06, chest + 0.12)
    parts = [
        ellipsoid("pillow", (0, y + 0.05, z + 0.07), (0.52, 0.33, 0.12), (0.99, 0.99, 1.0)),
        ellipsoid("head", (0, y, z + 0.27), (0.165, 0.2, 0.18), palette.SKIN),
        ellipsoid("hair", (0, y + 0.06, z + 0.255), (0.18, 0.19, 0.175), palette.HAIR),
        ellipsoid("nose", (0, y - 0.03, z + 0.45), (0.025, 0.035, 0.03), palette.SKIN),
        capsule("neck", (0, y - 0.22, z + 0.2), (pi / 2, 0, 0), 0.075, 0.12, palette.SKIN),
        ellipsoid("torso", (0, chest + 0.1, z + 0.14), (0.36, 0.42, 0.19), palette.GOWN),
        box("blanket", (-reach + 0.0, reach), blanket, (z - 0.17, z + 0.03), palette.BLANKET),
        box(
            "turned_down",
            (-reach - 0.003, reach + 0.003),
            (blanket[1] - 0.16, blanket[1] + 0.003),
            (z - 0.17, z + 0.04),
            palette.WHITE,
        ),
        ellipsoid("belly", (0, chest - 0.3, z + 0.07), (0.42, 0.55, 0.2), palette.BLANKET),
        ellipsoid("legs", (0, (foot + chest) / 2 - 0.12, z + 0.04), (0.36, 0.72, 0.14), palette.BLANKET),
        ellipsoid("feet", (0, foot + 0.3, z + 0.06), (0.26, 0.13, 0.17), palette.BLANKET),
    ]
    for side, sign in (("left", -1), ("right", 1)):
        parts += [
            ellipsoid(f"{side}_eye", (sign * 0.065, y + 0.03, z + 0.435), (0.022, 0.016, 0.015), palette.DARK),
            capsule(
                f"{side}_sleeve",
                (sign * 0.4, chest + 0.12, z + 0.13),
                (pi / 2, 0, sign * -0.12),
                0.09,
                0.3,
                palette.GOWN,
            ),
            capsule(
                f"{side}_arm", (sign * 0.44, chest - 0.28, z + 0.13), (pi / 2, 0, sign * 0.1), 0.065, 0.4, palette.SKIN
            ),
            ellipsoid(f"{side}_hand", (sign * 0.42, chest - 0.56, z + 0.13), (0.075, 0.11, 0.05), palette.SKIN),
        ]
    return parts


def _equipment(size: Size, head: float) -> list[Part]:
    """Drip and monitor beside the head, a linen chest behind the foot."""
    length, width = size.half_length, size.half_width
    drip, monitor = -0.85 * length, 0.8 * length
    y = head - 0.35
    return [
        cylinder("drip_foot", drip, y, (_STEP, _STEP + 0.03), 0.14, palette.DARK),
        cylinder("drip_pole", drip, y, (_STEP, 1.9), 0.018, palette.STEEL),
        box("drip_bag", (drip - 0.1, drip + 0.1), (y - 0.04, y + 0.04), (1.5, 1.82), (0.75, 0.90, 0.98, 0.8)),
        cylinder("monitor_pole", monitor, y, (_STEP, 1.3), 0.03, palette.STEEL),
        box("monitor", (monitor - 0.22, monitor + 0.22), (y - 0.04, y + 0.04), (1.2, 1.55), palette.DARK),
        box("monitor_screen", (monitor - 0.19, monitor + 0.19), (y - 0.045, y - 0.04), (1.24, 1.51), palette.SCREEN),
        box("pulse", (monitor - 0.17, monitor + 0.17), (y - 0.048, y - 0.045), (1.36, 1.385), (0.40, 0.95, 0.50)),
        box(
            "linen_chest",
            (-0.55 * length, 0.55 * length),
            (-0.9 * width, -0.62 * width),
            (_STEP, 0.62),
            palette.DARK_WOOD,
            solid=True,
        ),
        box("linen_chest_cushion", (-0.55 * length, 0.55 * length), (-0.9 * width, -0.62 * width), (0.62, 0.7), _PINK),
    ]


def bedside_table(size: Size) -> list[Part]:
    """A small cabinet whose drawers look towards -x, where the robot stands; its top is free to put things on."""
    length, width, top = size.half_length, size.half_width, size.height
    parts = [
        box("body", (-length, length), (-width, width), (0, top), None, solid=True),
        box("carcass", (-length + 0.012, length), (-width + 0.01, width - 0.01), (0.06, top - 0.03), palette.WOOD),
        box("top", (-length, length), (-width, width), (top - 0.03, top), _PINK),
    ]
    for i, (low, high) in enumerate(((0.1, 0.38), (0.4, 0.68))):
        scaled = (low * top / 0.75, high * top / 0.75)
        parts.append(
            box(f"drawer_{i}", (-length + 0.002, -length + 0.012), (-width + 0.03, width - 0.03), scaled, palette.CREAM)
        )
        grip = (scaled[1] - 0.08, scaled[1] - 0.06)
        parts.append(box(f"grip_{i}", (-length, -length + 0.002), (-0.06, 0.06), grip, palette.DARK))
    return parts


def privacy_screen(size: Size) -> list[Part]:
    """Curtains between posts."""
    length, width, top = size.half_length, size.half_width, size.height
    count = max(1, round(2 * length / 0.9))
    step = 2 * length / count
    parts = [
        box("body", (-length, length), (-width, width), (0, top), None, solid=True),
        box("rail", (-length, length), (-0.4 * width, 0.4 * width), (top - 0.05, top), palette.STEEL),
    ]
    for i in range(count):
        left = -length + i * step
        fold = 0.25 * width * (1 if i % 2 else -1)
        parts.append(
            box(
                f"curtain_{i}",
                (left + 0.04, left + step - 0.04),
                (fold - 0.25 * width, fold + 0.25 * width),
                (0.12, top - 0.05),
                palette.CURTAIN,
            )
        )
    for i in range(count + 1):
        x = min(max(-length + i * step, -length + 0.03), length - 0.03)
        parts.append(box(f"post_{i}", (x - 0.025, x + 0.025), (-0.6 * width, 0.6 * width), (0.04, top), palette.STEEL))
        parts.append(box(f"foot_{i}", (x - 0.03, x + 0.03), (-width, width), (0, 0.04), palette.DARK))
    return parts
