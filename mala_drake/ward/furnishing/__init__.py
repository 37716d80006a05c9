"""What the ward's furniture is made of: one function a model, from a size to parts.

A model named in the map is built for the size that the map gives; its solid parts fill exactly the map's footprint.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from mala_drake.ward.furnishing import hall, kitchen, sickroom, storage
from mala_drake.ward.furnishing.parts import Part, Size

BUILDERS: Mapping[str, Callable[[Size], list[Part]]] = {
    function.__name__: function
    for function in (
        storage.pharmacy_cabinet,
        storage.supply_rack,
        storage.pantry_shelf,
        kitchen.fridge,
        kitchen.kitchen_counter,
        kitchen.stove,
        kitchen.quality_counter,
        sickroom.bed,
        sickroom.bedside_table,
        sickroom.privacy_screen,
        hall.wall,
        hall.partition,
        hall.reception_desk,
        hall.trolley,
        hall.planter,
        hall.waiting_chairs,
        hall.charging_post,
    )
}
"""By the map's `model`."""

ROUND_MODELS = frozenset({"charging_post", "planter"})
"""Models with a round footprint: they take a radius and no half sizes."""
