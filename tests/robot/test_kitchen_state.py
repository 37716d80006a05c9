from dataclasses import replace

import pytest

import mala_drake.robot.kitchen_state as mut
from mala_drake.messages import Outcome
from mala_drake.ward.in_place_actions import in_place_action
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import LoadWard

NUTS, GREENS, RESERVE, CHICKEN = "pantry/nuts", "pantry/vegetables", "pantry/vegetables_2", "fridge/chicken"
SALAD, HOT = (NUTS, GREENS), (CHICKEN, GREENS)


@pytest.fixture(scope="module")
def items():
    return {item.name: item for item in all_items(LoadWard(), ("meal",))}


def do(state, name, *arguments, boxes=("", ""), outcome=Outcome.SUCCESS, served=()):
    action = in_place_action(name, ("robot1", *arguments))
    return mut.conclude_in_kitchen(state, action, outcome, boxes, served=served)


def prepared(dish, boxes, *names):
    state = do(mut.KitchenState(), f"choose_{dish}")
    for name in names:
        state = do(state, name, dish, boxes=boxes)
    return state


def atoms(state, boxes, items):
    return set(mut.kitchen_atoms(state, boxes, items, robot="robot1"))


def own(predicates):
    return {(predicate, "robot1") for predicate in predicates}


def test_at_first_nothing_is_chosen_and_the_workspace_is_a_risk(items):
    assert atoms(mut.KitchenState(), (), items) == {("cross-contamination-risk",)}


def test_a_chosen_dish_misses_what_is_not_in_the_gripper(items):
    state = prepared("salad", SALAD)
    known = {("meal_to_prepare", "robot1", "salad"), ("cross-contamination-risk",)}
    missing = {kind: ("missing_ingredient", "robot1", kind) for kind in ("nuts", "vegetables")}
    collected = {kind: ("collected_ingredient", "robot1", kind) for kind in ("nuts", "vegetables")}
    assert atoms(state, (), items) == known | set(missing.values())
    assert atoms(state, ("", GREENS), items) == known | {missing["nuts"], collected["vegetables"]}
    assert atoms(state, SALAD, items) == known | set(collected.values())


def test_another_dish_can_be_chosen(items):
    state = do(prepared("sandwich", SALAD), "choose_salad")
    chosen = {atom for atom in atoms(state, (), items) if atom[0] == "meal_to_prepare"}
    assert chosen == {("meal_to_prepare", "robot1", "salad")}


def test_what_has_been_done_holds_of_the_boxes_in_the_gripper(items):
    steps = ("check_ingredients", "sanitize_workspace", "wash_ingredients", "chop_ingredients")
    state = prepared("salad", SALAD, *steps)
    done = own(("ingredients_checked", "ingredients_safe", "ingredients_washed", "ingredients_chopped"))
    assert done <= atoms(state, SALAD, items)
    # A lost box, or another one in its place: it is all to be done again.
    assert not done & atoms(state, (NUTS, ""), items)
    assert not done & atoms(state, (NUTS, RESERVE), items)
    again = do(state, "check_ingredients", "salad", boxes=(NUTS, RESERVE))
    assert own(("ingredients_checked", "ingredients_safe")) <= atoms(again, (NUTS, RESERVE), items)
    assert ("ingredients_washed", "robot1") not in atoms(again, (NUTS, RESERVE), items)


@pytest.mark.parametrize("outcome", [each for each in Outcome if each is not Outcome.SUCCESS])
def test_only_success_has_an_effect(outcome):
    state = prepared("salad", SALAD)
    for name in ("choose_sandwich", "check_ingredients", "sanitize_workspace", "wash_ingredients", "cook_meal"):
        assert do(state, name, "salad", boxes=SALAD, outcome=outcome) == state


def test_nothing_is_done_to_a_box_that_is_not_there():
    state = prepared("salad", SALAD)
    assert do(state, "wash_ingredients", boxes=(NUTS, "")) == state


def test_cleaning_and_what_soils_again(items):
    state = prepared("salad", SALAD, "check_ingredients", "sanitize_workspace")
    clean = {("workspace-clean",), ("robot-hands-clean", "robot1")}
    risk = ("cross-contamination-risk",)
    assert clean <= atoms(state, SALAD, items)
    assert risk not in atoms(state, SALAD, items)
    chopped = do(do(state, "wash_ingredients", boxes=SALAD), "chop_ingredients", "salad", boxes=SALAD)
    assert clean & atoms(chopped, SALAD, items) == {("robot-hands-clean", "robot1")}
    assert risk not in atoms(chopped, SALAD, items)  # A salad is eaten raw.
    # Whatever hangs at the pad has been touched, even if the action failed later on.
    touched = do(state, "collect_ingredient", "pantry", "nuts", boxes=(NUTS, ""), outcome=Outcome.CANCELLED)
    assert ("robot-hands-clean", "robot1") not in atoms(touched, SALAD, items)
    assert risk in atoms(touched, SALAD, items)
    assert do(state, "collect_ingredient", "pantry", "nuts", outcome=Outcome.NOT_THERE) == state


def test_raw_chicken_is_a_risk_until_it_is_cooked(items):
    raw = prepared("hot_meal", HOT, "check_ingredients", "sanitize_workspace", "wash_ingredients", "chop_ingredients")
    risk = ("cross-contamination-risk",)
    assert risk in atoms(raw, HOT, items)
    cooked = do(raw, "cook_meal", "hot_meal", boxes=HOT)
    assert risk not in atoms(cooked, HOT, items)
    assert ("meal_cooked", "robot1") in atoms(cooked, HOT, items)


def test_a_finished_dish_can_be_delivered_where_a_table_is_within_reach(items):
    finished = prepared("salad", SALAD, "check_palatability", "assemble")
    deliverable = ("can_be_deliverable", "robot1")
    assert deliverable not in atoms(finished, SALAD, items)
    there = replace(finished, at_bedside=True)
    assert deliverable in atoms(there, SALAD, items)
    assert deliverable not in atoms(there, (NUTS, ""), items)
    assert deliverable not in atoms(replace(prepared("salad", SALAD, "assemble"), at_bedside=True), SALAD, items)


def test_a_served_meal_is_what_lies_on_the_table(items):
    finished = replace(prepared("salad", SALAD, "check_palatability", "assemble"), at_bedside=True)
    served = do(finished, "deliver_on_bedside_table_left", "salad", served=SALAD)
    found = atoms(served, (), items)
    assert own(("meal_palatable", "meal_assembled")) <= found
    assert not {atom[0] for atom in found} & {"missing_ingredient", "collected_ingredient", "can_be_deliverable"}
    half = do(finished, "deliver_on_bedside_table_left", "salad", served=())
    assert half == finished


def test_atoms_are_sorted(items):
    found = mut.kitchen_atoms(prepared("salad", SALAD, "check_ingredients"), SALAD, items, robot="robot1")
    assert list(found) == sorted(found)
