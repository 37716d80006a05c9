"""Messages about the medicine boxes, between the world, the executor and the magnet."""

from __future__ import annotations

from dataclasses import dataclass

from mala_drake.messages import Message
from mala_drake.ward.items import ItemPose


@dataclass(frozen=True, slots=True)
class HandedItem(Message):
    """The box that a dispenser holds out in answer to the collect action `sequence`; no name when out of stock."""

    sequence: int = 0
    item: str = ""
    pose: ItemPose = ItemPose()


@dataclass(frozen=True, slots=True)
class ClampedItems(Message):
    """The boxes that dispensers keep in place, each with its pose."""

    items: tuple[tuple[str, ItemPose], ...] = ()
