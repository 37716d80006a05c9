import pytest

import mala_drake.ward.in_place_actions as mut
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
