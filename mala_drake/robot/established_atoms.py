"""What the robot's sensors have established about the world, as atoms of the planning domains."""

from __future__ import annotations

from collections.abc import Mapping

from mala_drake.messages import Atom
from mala_drake.robot.kitchen_state import kitchen_atoms
from mala_drake.robot.world_state import WorldState
from mala_drake.ward.in_place_actions import SLOTS, ingredient_slot
from mala_drake.ward.items import Item


def established_atoms(state: WorldState, items: Mapping[str, Item], *, robot: str) -> tuple[Atom, ...]:
    """What has been established by now, sorted.

    Args:
        state: the truth about the boxes, and what is known of it.
        items: all boxes by name. Only where there are ingredients anything is known of meals.
        robot: its name in the atoms.
    """
    atoms: set[Atom] = {_in_stock(items[name]) for name in state.stock}
    for slot, carried in zip(SLOTS, state.carried, strict=True):
        if carried.item and carried.label and ingredient_slot(carried.label) is None:
            atoms |= {(f"has-{slot}", robot), (f"{slot}-is", robot, carried.label)}
            if carried.verdict:
                atoms.add((f"{carried.verdict}-{slot}", robot))
    if any(_is_ingredient(item) for item in items.values()):
        known = [carried.item for carried in state.carried if carried.label and _is_ingredient(items[carried.item])]
        atoms |= set(kitchen_atoms(state.kitchen, known, items, robot=robot))
    if state.delivered:
        atoms.add(("delivered", robot))
    return tuple(sorted(atoms))


def _in_stock(item: Item) -> Atom:
    return ("ingredient_available" if _is_ingredient(item) else "available", item.kind, item.place)


def _is_ingredient(item: Item) -> bool:
    return ingredient_slot(item.kind) is not None
