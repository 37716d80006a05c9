"""Signs that say which place is which, readable from the south and from above."""

from __future__ import annotations

from math import pi

import shapely

from mala_drake.ward.furnishing import palette
from mala_drake.ward.furnishing.flat import lettering
from mala_drake.ward.furnishing.parts import Part, box, cylinder, mesh

_SIZE = 0.46  # Font size, metres.
_MARGIN = 0.16  # Of the panel around the letters, metres.
_TILT = pi / 4  # Of the panel's face from the horizon towards the sky, radians.
_BOTTOM = 2.25  # Height of the panel's middle, metres.
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


def _ink(category: str) -> palette.Color:
    red, green, blue = palette.FUNCTION_COLORS[category]
    return palette.DARK if 0.3 * red + 0.6 * green + 0.1 * blue > 0.6 else palette.WHITE


def _panel_half_size(name: str) -> tuple[float, float]:
    lines = sign_lines(name)
    return 0.36 * _SIZE * max(map(len, lines)) + _MARGIN, 0.6 * _SIZE * len(lines) + 0.5 * _MARGIN


def standing_sign(name: str, category: str, letters_uri: str) -> list[Part]:
    """A panel on a pole, facing south and tilted towards the sky."""
    half_width, half_height = _panel_half_size(name)
    rotation = (pi / 2 - _TILT, 0.0, 0.0)
    panel = box("panel", (-half_width, half_width), (-half_height, half_height), (-0.02, 0.02), palette.FUNCTION_COLORS[category])
    # The letters lie 3 cm in front of the panel's middle, along the panel's normal (0, -cos tilt, sin tilt).
    return [
        cylinder("pole", 0, 0, (0, _BOTTOM), 0.03, palette.GRAY),
        Part(panel.name, panel.geometry, (0, 0, _BOTTOM), rotation, panel.color),
        mesh("letters", letters_uri, _ink(category), position=(0, -0.0212, _BOTTOM + 0.0212), rotation=rotation),
    ]


def floor_sign(name: str, category: str, letters_uri: str) -> list[Part]:
    """A round mat with the name, for a place that has no furniture."""
    half_width, _ = _panel_half_size(name)
    return [
        cylinder("mat", 0, 0, (0, 0.004), half_width + 0.1, palette.FUNCTION_COLORS[category]),
        mesh("letters", letters_uri, _ink(category), position=(0, 0, 0.012)),
    ]
