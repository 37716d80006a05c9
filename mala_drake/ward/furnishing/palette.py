"""The ward's colors: function first, so that a glance tells what a piece of furniture is for."""

from __future__ import annotations

Color = tuple[float, float, float] | tuple[float, float, float, float]
"""Red, green, blue and, where it is not opaque, alpha; all in [0, 1]."""

FUNCTION_COLORS: dict[str, tuple[float, float, float]] = {
    "home": (0.45, 0.50, 0.56),
    "pharmacy": (0.10, 0.62, 0.36),
    "supply": (0.16, 0.45, 0.82),
    "charger": (0.97, 0.78, 0.10),
    "kitchen": (0.95, 0.52, 0.14),
    "bedside": (0.90, 0.38, 0.58),
}
"""By category of the place that the furniture serves."""

WHITE = (0.97, 0.97, 0.96)
CREAM = (0.95, 0.92, 0.85)
GRAY = (0.62, 0.65, 0.68)
STEEL = (0.78, 0.81, 0.84)
DARK = (0.20, 0.22, 0.25)
WOOD = (0.78, 0.60, 0.40)
DARK_WOOD = (0.55, 0.38, 0.24)
LEAF = (0.22, 0.55, 0.24)
LIGHT_LEAF = (0.38, 0.68, 0.30)
TERRACOTTA = (0.76, 0.42, 0.28)
SKIN = (0.94, 0.76, 0.63)
HAIR = (0.36, 0.25, 0.18)
BLANKET = (0.45, 0.68, 0.84)
GOWN = (0.66, 0.84, 0.80)
RED = (0.84, 0.22, 0.20)
SCREEN = (0.25, 0.55, 0.72)
GLASS = (0.72, 0.86, 0.94, 0.28)
CURTAIN = (0.55, 0.78, 0.80, 0.85)

FLOOR = (0.93, 0.93, 0.90)
BUSY_FLOOR = (1.00, 0.50, 0.32)
"""What the floor's color tends to where the congestion level tends to 1."""


def floor_color(level: float) -> tuple[float, float, float]:
    """The floor's color in a zone of congestion `level` in [0, 1)."""
    return (
        FLOOR[0] + level * (BUSY_FLOOR[0] - FLOOR[0]),
        FLOOR[1] + level * (BUSY_FLOOR[1] - FLOOR[1]),
        FLOOR[2] + level * (BUSY_FLOOR[2] - FLOOR[2]),
    )
