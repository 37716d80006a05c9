"""The dishes that the kitchen offers: what each is made of, and what sets one apart from another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Dish:
    """One dish.

    Attributes:
        name: as in the planning domain.
        ingredients: what it is made of, one for each pad of the gripper.
        cooked: whether it has to be cooked.
        assembling: seconds that it takes to arrange it.
        presentation_error: how far its looks are from the best that one could serve, in units of the approach error.
    """

    name: str
    ingredients: tuple[str, str]
    cooked: bool
    assembling: float
    presentation_error: float


DISHES: Mapping[str, Dish] = MappingProxyType(
    {
        dish.name: dish
        for dish in (
            Dish("sandwich", ("bread", "vegetables"), cooked=False, assembling=5.0, presentation_error=1.15),
            Dish("salad", ("nuts", "vegetables"), cooked=False, assembling=13.4, presentation_error=0.84),
            Dish("hot_meal", ("chicken", "vegetables"), cooked=True, assembling=5.0, presentation_error=0.06),
        )
    }
)
"""By name. A salad is arranged leaf by leaf: that is what its looks cost."""


def presentation_error(name: str) -> float:
    """That of a dish; 0 for what is no dish: nobody asks of medicine that it looks good."""
    return DISHES[name].presentation_error if name in DISHES else 0.0
