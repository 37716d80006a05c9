"""The boxes of the ward: what there is, where each stands, and where boxes may be put.

Every pharmacy keeps one box of each medicine and every supply room one of each supplement; the kitchen's pantry and
fridge keep ingredients. They stand side by side on the ledge in front of the robot's standing pose. All of it follows
from the map alone.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

from mala_drake.messages import Message
from mala_drake.ward.ward_map import Place, Ward

ITEM_SIZE = (0.08, 0.06, 0.10)
"""Depth, width and height of every box, metres."""

ITEM_HALF_HEIGHT = 0.5 * ITEM_SIZE[2]

LEDGE_HEIGHT = 0.78
"""Metres above the floor of the ledge in front of whatever keeps items."""

KINDS = {
    "pharmacy": ("med_antibiotic", "med_analgesic", "med_insulin"),
    "supply": ("supp_vitamin_d", "supp_electrolyte", "supp_omega3"),
}
"""What is kept at places of a category, from the robot's left to its right."""

KITCHEN_KINDS = {"pantry": ("bread", "vegetables", "vegetables", "nuts"), "fridge": ("chicken",)}
"""What is kept at a place of the kitchen, from the robot's left to its right. One meal's vegetables are in reserve."""

TASKS = ("medication", "meal")
"""The tasks that need boxes."""

_SHELF_AHEAD = 0.70  # Metres from the standing point along its yaw.
# The box that hangs at the gripper's other pad is 0.14 m beside the one that is picked, and all are 0.06 m wide.
_SHELF_ASIDE = (0.24, 0.0, -0.24)  # Metres to the left of the standing pose.
_KITCHEN_SPACING = 0.24  # Metres between neighbours on a ledge of the kitchen.
# Where a box is put whose own place is taken. From 0.50 m on it is clear of a box carried along while another is picked
# from the shelf; what is nearer is for an arm that does not reach so far.
_RETURN_ASIDE = (0.50, -0.50, 0.46, -0.46, 0.38, -0.38)
_TABLE_AHEAD = 0.76
_TABLE_ASIDE = (0.14, -0.14)


@dataclass(frozen=True, slots=True)
class ItemPose(Message):
    """Where a box is: its centre in the world, metres, standing upright, and its yaw, radians."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    yaw: float = 0.0


@dataclass(frozen=True, slots=True)
class Item(Message):
    """One box. Its name is `<place>/<kind>`, with a number for the second of a kind at the place."""

    name: str
    kind: str
    place: str
    shelf_pose: ItemPose


def all_items(ward: Ward, tasks: Collection[str] = TASKS) -> tuple[Item, ...]:
    """All boxes that the tasks need, by place in the order of the map, then from left to right."""
    items: list[Item] = []
    if "medication" in tasks:
        items += [
            Item(f"{place.name}/{kind}", kind, place.name, _spot(place, _SHELF_AHEAD, aside, LEDGE_HEIGHT))
            for place in ward.places
            for kind, aside in zip(KINDS.get(place.category, ()), _SHELF_ASIDE, strict=False)
        ]
    if "meal" in tasks:
        items += [item for place in ward.places for item in _ingredients(place)]
    return tuple(items)


def _ingredients(place: Place) -> list[Item]:
    """What the kitchen keeps at a place."""
    kinds = KITCHEN_KINDS.get(place.name, ()) if place.category == "kitchen" else ()
    items = []
    for i, kind in enumerate(kinds):
        number = kinds[: i + 1].count(kind)
        name = f"{place.name}/{kind}" + (f"_{number}" if number > 1 else "")
        aside = _KITCHEN_SPACING * (0.5 * (len(kinds) - 1) - i)
        items.append(Item(name, kind, place.name, _spot(place, _SHELF_AHEAD, aside, LEDGE_HEIGHT)))
    return items


def return_spots(ward: Ward, place: str, kind: str) -> tuple[ItemPose, ...]:
    """Where a box of `kind` may be put back at `place`, the best first; empty where nothing is kept.

    The best is where that kind stands: the dispenser takes its box back there, and the shelf stays in order.
    """
    standing = ward.place.get(place)
    if standing is None or standing.category not in KINDS:
        return ()
    own = [aside for kept, aside in zip(KINDS[standing.category], _SHELF_ASIDE, strict=True) if kept == kind]
    return tuple(_spot(standing, _SHELF_AHEAD, aside, LEDGE_HEIGHT) for aside in (*own, *_RETURN_ASIDE))


def table_spots(ward: Ward, place: str) -> tuple[ItemPose, ...]:
    """Where the middle of a pair of boxes may be put on the bedside table at `place`; empty where there is none."""
    standing, table = ward.place.get(place), ward.furniture_of.get(place)
    if standing is None or standing.category != "bedside" or table is None:
        return ()
    return tuple(_spot(standing, _TABLE_AHEAD, aside, table.height) for aside in _TABLE_ASIDE)


def work_spot(ward: Ward, place: str) -> ItemPose | None:
    """Where the middle of a pair of boxes is worked on at `place`: on the ledge of a kitchen's furniture."""
    standing = ward.place.get(place)
    if standing is None or standing.category != "kitchen" or place not in ward.furniture_of:
        return None
    return _spot(standing, _SHELF_AHEAD, 0.0, LEDGE_HEIGHT)


def _spot(place: Place, ahead: float, aside: float, surface: float) -> ItemPose:
    """The pose of a box on a surface of that height, seen from the standing pose."""
    cosine, sine = math.cos(place.yaw), math.sin(place.yaw)
    x = place.x + ahead * cosine - aside * sine
    y = place.y + ahead * sine + aside * cosine
    return ItemPose(x, y, surface + ITEM_HALF_HEIGHT, place.yaw)
