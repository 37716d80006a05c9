"""The five patient profiles of the paper (Table "Patient profile weight vectors")."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from mala_drake.errors import BadInput

PROFILES: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        "speed_oriented": (0.50, 0.12, 0.14, 0.14, 0.10),
        "safety_first": (0.10, 0.50, 0.15, 0.15, 0.10),
        "energy_conscious": (0.15, 0.15, 0.45, 0.15, 0.10),
        "comfort_focused": (0.15, 0.15, 0.10, 0.40, 0.20),
        "presentation_focused": (0.05, 0.10, 0.05, 0.20, 0.60),
    }
)
"""True preference weights w* by profile name: (time, safety, battery, proximity, approach), on the simplex."""


def profile_weights(name: str, *, where: str = "profile") -> tuple[float, ...]:
    """The true weights w* of the profile `name`.

    Raises:
        BadInput: if there is no such profile; `where` names the option or field it was read from.
    """
    if name not in PROFILES:
        raise BadInput(where, repr(name), f"one of {', '.join(PROFILES)}")
    return PROFILES[name]
