from dataclasses import replace

import pytest

import mala_drake.robot.established_atoms as mut
from mala_drake.robot.kitchen_state import KitchenState
from mala_drake.robot.world_state import Carried, WorldState
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import LoadWard

ANTIBIOTIC, NUTS = "pharmacy_north/med_antibiotic", "pantry/nuts"


@pytest.fixture(scope="module")
def items():
    return {item.name: item for item in all_items(LoadWard())}


@pytest.fixture
def full(items):
    return WorldState(stock=tuple(items))


def atoms(state, items):
    return mut.established_atoms(state, items, robot="robot1")


def test_the_stock_seen_is_the_stock_there_is(full, items):
    def stock(state):
        return {atom for atom in atoms(state, items) if "available" in atom[0]}

    medicines = {item for item in items.values() if item.place not in ("pantry", "fridge")}
    assert stock(full) == {
        *(("available", item.kind, item.place) for item in medicines),
        *(("ingredient_available", item.kind, item.place) for item in set(items.values()) - medicines),
    }
    emptied = replace(full, stock=tuple(name for name in full.stock if name not in (ANTIBIOTIC, NUTS)))
    gone = {("available", "med_antibiotic", "pharmacy_north"), ("ingredient_available", "nuts", "pantry")}
    assert stock(full) - stock(emptied) == gone
    # Of two boxes of a kind one is enough.
    less = replace(full, stock=tuple(name for name in full.stock if name != "pantry/vegetables"))
    assert stock(less) == stock(full)


def test_atoms_are_sorted(full, items):
    carrying = replace(full, carried=(Carried(ANTIBIOTIC, "med_antibiotic", "correct"), Carried()))
    assert list(atoms(carrying, items)) == sorted(atoms(carrying, items))


def test_what_is_carried_is_told_by_what_it_is_taken_for(full, items):
    medicine = atoms(replace(full, carried=(Carried(ANTIBIOTIC, "med_insulin"), Carried())), items)
    assert ("medication-is", "robot1", "med_insulin") in medicine
    assert not [atom for atom in medicine if atom[0] == "collected_ingredient"]
    food = atoms(replace(full, carried=(Carried(NUTS, "nuts"), Carried())), items)
    assert ("collected_ingredient", "robot1", "nuts") in food
    assert not [atom for atom in food if atom[0].startswith(("has-", "medication-is"))]


def test_a_box_is_not_known_before_it_has_been_collected(full, items):
    assert atoms(replace(full, carried=(Carried(NUTS), Carried(ANTIBIOTIC))), items) == atoms(full, items)


def test_where_there_are_no_ingredients_nothing_is_known_of_meals(full, items):
    medicines = {item.name: item for item in all_items(LoadWard(), ("medication",))}
    state = WorldState(stock=tuple(medicines), kitchen=KitchenState(dish="salad"))
    assert {atom[0] for atom in atoms(state, medicines)} == {"available"}
    assert ("meal_to_prepare", "robot1", "salad") in atoms(replace(full, kitchen=state.kitchen), items)
