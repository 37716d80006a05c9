import pytest

import mala_drake.ward.in_place_actions as mut
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.in_place_actions import Verb
from mala_drake.ward.items import KINDS


@pytest.mark.parametrize(
    ("name", "seconds", "charge"),
    [
        ("collect_med_antibiotic", 5, 0.05),
        ("collect_supp_omega3", 5, 0.05),
        ("check_medication_correct", 2, 0.02),
        ("check_supplement_wrong", 2, 0.02),
        ("put_down_medicine", 3, 0.05),
        ("put_down_supplement", 3, 0.05),
        ("deliver_on_bedside_table_left", 20, 0.02),
        ("deliver_on_bedside_table_right", 20, 0.02),
        ("recharge", 30, 0),
    ],
)
def test_seconds_and_charge_are_those_of_the_hospital_case(name, seconds, charge):
    action = mut.in_place_action(name)
    assert (action.seconds, action.charge) == (seconds, charge)


@pytest.mark.parametrize("slot", [0, 1])
def test_every_kind_that_is_kept_can_be_collected_into_its_slot(slot):
    for kind in KINDS[("pharmacy", "supply")[slot]]:
        assert mut.in_place_action(f"collect_{kind}") == mut.InPlaceAction(Verb.COLLECT, slot=slot, kind=kind)


def test_a_check_knows_its_slot_and_its_verdict():
    assert mut.in_place_action("check_supplement_wrong") == mut.InPlaceAction(Verb.CHECK, slot=1, verdict="wrong")
    assert mut.in_place_action("check_medication_correct") == mut.InPlaceAction(Verb.CHECK, slot=0, verdict="correct")


@pytest.mark.parametrize("name", ["", "go_to_pharmacy_north", "collect_med_", "check_medication", "deliver"])
def test_other_names_are_no_in_place_actions(name):
    assert mut.in_place_action(name) is None


@pytest.mark.parametrize(
    ("name", "arguments", "seconds", "charge"),
    [
        ("choose_hot_meal", (), 0.5, 0.0),
        ("collect_ingredient", ("pantry", "bread"), 5, 0.02),
        ("check_ingredients", ("salad",), 4, 0.01),
        ("sanitize_workspace", (), 5, 0.02),
        ("wash_ingredients", (), 6, 0.02),
        ("chop_ingredients", ("salad",), 8, 0.03),
        ("cook_meal", ("hot_meal",), 12, 0.5),
        ("check_cooking_level", (), 4, 0.01),
        ("check_palatability", ("hot_meal",), 4, 0.01),
        ("assemble", ("sandwich",), 5, 0.02),
        ("deliver_on_bedside_table_left", ("sandwich",), 10, 0.01),
        ("deliver_on_bedside_table_right", ("salad",), 10, 0.01),
    ],
)
def test_seconds_and_charge_of_a_meal_are_those_of_the_hospital_case(name, arguments, seconds, charge):
    action = mut.in_place_action(name, ("robot1", *arguments))
    assert (action.seconds, action.charge) == (seconds, charge)


def test_the_arguments_tell_a_meal_from_a_medicine():
    name = "deliver_on_bedside_table_left"
    assert mut.in_place_action(name, ("robot1",)) == mut.InPlaceAction(Verb.DELIVER)
    assert mut.in_place_action(name, ("robot1", "salad")) == mut.InPlaceAction(Verb.SERVE, dish="salad")


def test_a_salad_takes_longer_to_arrange():
    plain, salad = (mut.in_place_action("assemble", ("robot1", dish)) for dish in ("sandwich", "salad"))
    assert salad.seconds > plain.seconds
    assert mut.in_place_action("assemble").seconds == plain.seconds


@pytest.mark.parametrize("dish", DISHES.values(), ids=lambda dish: dish.name)
def test_the_two_ingredients_of_a_dish_have_a_pad_each(dish):
    for slot, kind in enumerate(dish.ingredients):
        action = mut.in_place_action("collect_ingredient", ("robot1", "pantry", kind))
        assert action == mut.InPlaceAction(Verb.COLLECT_INGREDIENT, slot=slot, kind=kind)
        assert mut.ingredient_slot(kind) == slot


@pytest.mark.parametrize(("name", "arguments"), [("choose_soup", ()), ("collect_ingredient", ("robot1", "caviar"))])
def test_what_the_kitchen_does_not_know_is_no_action(name, arguments):
    assert mut.in_place_action(name, arguments) is None
    assert mut.ingredient_slot("med_insulin") is None


def test_every_verb_has_seconds_charge_and_a_task():
    assert set(mut.SECONDS) == set(mut.CHARGE) == set(Verb)
    assert {verb for verbs in mut.VERBS.values() for verb in verbs} == set(Verb)
