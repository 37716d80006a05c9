"""Signs that say which place is which, readable from the south and from above."""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, pi, sin

import shapely

from mala_drake.ward.furnishing import palette
from mala_drake.ward.furnishing.flat import lettering
from mala_drake.ward.furnishing.parts import Part, box, cylinder, mesh

_SIZE = 0.46  # Font size, metres.
_MARGIN = 0.14  # Of the panel around the letters, metres.
_TILT = pi / 4  # Of the panel's face from the horizon towards the sky, radians.
_LOWEST, _RAISE = 2.8, 0.4  # Height of the panel's middle, and by how much it is raised while it hides another; metres.
_LINE_LENGTH = 8  # Longer texts are broken in two.


def sign_lines(name: str) -> tuple[str, ...]:
    """The text on the sign of the place `name`: `("Pharmacy", "north")` for `pharmacy_north`."""
    words = name.split("_")
    words[0] = words[0][:1].upper() + words[0][1:]
    text = " ".join(words)
    if len(text) <= _LINE_LENGTH or len(words) == 1:
        return (text,)
    breaks = [(" ".join(words[:i]), " ".join(words[i:])) for i in range(1, len(words))]
    return min(breaks, key=lambda lines: max(map(len, lines)))


def sign_letters(name: str) -> shapely.MultiPolygon:
    """The letters of the place's sign, in the plane of its panel."""
    return lettering(sign_lines(name), size=_SIZE)


def sign_heights(positions: Mapping[str, tuple[float, float]]) -> dict[str, float]:
    """How high the signs of the places stand, so that seen from the south none hides another; metres, in 0.4 m steps.

    Args:
        positions: x and y of the signs' poles, by the name of the place.
    """
    heights: dict[str, float] = {}
    seen: list[shapely.Polygon] = []
    # From south to north: a sign further back is raised until it shows above those before it.
    for name in sorted(positions, key=lambda name: (positions[name][1], name)):
        x, y = positions[name]
        half_width, half_height = _panel_half_size(name)
        height = _LOWEST
        while True:
            up = y * sin(_TILT) + height * cos(_TILT)
            panel = shapely.box(x - half_width, up - half_height, x + half_width, up + half_height)
            if not any(panel.intersects(other) for other in seen):
                break
            height = round(height + _RAISE, 3)
        heights[name] = height
        seen.append(panel)
    return heights


def _ink(category: str) -> palette.Color:
    red, green, blue = palette.FUNCTION_COLORS[category]
    return palette.DARK if 0.3 * red + 0.6 * green + 0.1 * blue > 0.6 else palette.WHITE


def _panel_half_size(name: str) -> tuple[float, float]:
    lines = sign_lines(name)
    return 0.345 * _SIZE * max(map(len, lines)) + _MARGIN, 0.6 * _SIZE * len(lines) + 0.5 * _MARGIN


def standing_sign(name: str, category: str, letters_uri: str, height: float) -> list[Part]:
    """A panel on a pole, facing south and tilted towards the sky, its middle at `height` metres."""
    half_width, half_height = _panel_half_size(name)
    rotation = (pi / 2 - _TILT, 0.0, 0.0)
    panel = box(
        "panel",
        (-half_width, half_width),
        (-half_height, half_height),
        (-0.02, 0.02),
        palette.FUNCTION_COLORS[category],
    )
    # The letters lie 3 cm in front of the panel's middle, along the panel's normal (0, -cos tilt, sin tilt).
    return [
        cylinder("pole", 0, 0, (0, height), 0.03, palette.GRAY),
        Part(panel.name, panel.geometry, (0, 0, height), rotation, panel.color),
        mesh("letters", letters_uri, _ink(category), position=(0, -0.0212, height + 0.0212), rotation=rotation),
    ]


def floor_sign(name: str, category: str, letters_uri: str) -> list[Part]:
    """A mat with the name, for a place that has no furniture."""
    half_width, half_height = _panel_half_size(name)
    across, along = (-half_width, half_width), (-half_height, half_height)
    return [
        box("mat", across, along, (0, 0.008), palette.FUNCTION_COLORS[category]),
        mesh("letters", letters_uri, _ink(category), position=(0, 0, 0.016)),
    ]


def place_mark(category: str, mark_uri: str) -> list[Part]:
    """What is painted on the floor where the robot stands."""
    return [mesh("mark", mark_uri, palette.FUNCTION_COLORS[category], position=(0, 0, 0.006))]
