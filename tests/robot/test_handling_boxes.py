"""World, executor, arm and magnet together on the plant: boxes are really collected, put down and delivered."""

import math

import pytest
from pydrake.math import RigidTransform

from mala_drake.messages import Action, ActionKind, Outcome
from mala_drake.ward.items import LEDGE_HEIGHT, all_items
from mala_drake.ward.ward_map import LoadWard

from .stage import Stage

NORTH, SUPPLY, RIGHT = "pharmacy_north", "supply_A", "patient_bed_right"


@pytest.mark.parametrize(
    "arrival",
    [
        pytest.param((-0.1, 0.1, 0.2), id="short of the place, to its left"),
        pytest.param((0.0, 0.0, 0.0), id="exactly there", marks=pytest.mark.slow),
        pytest.param((0.1, -0.1, -0.2), id="beyond the place, to its right", marks=pytest.mark.slow),
    ],
)
def test_a_medicine_and_a_supplement_are_collected_checked_and_delivered(arrival):
    stage = Stage()
    for place, names in (
        (NORTH, ("collect_med_antibiotic", "check_medication_correct")),
        (SUPPLY, ("collect_supp_vitamin_d", "check_supplement_correct")),
        (RIGHT, ("deliver_on_bedside_table_right",)),
    ):
        stage.stand_at(place, *arrival)
        for name in names:
            outcome, _ = stage.do(name)
            assert outcome is Outcome.SUCCESS, name
    assert stage.facts() == {"delivered"}
    table = stage.ward.furniture_of[RIGHT]
    delivered = (f"{NORTH}/med_antibiotic", f"{SUPPLY}/supp_vitamin_d")
    for item in delivered:
        x, y, z = stage.position(item)
        assert math.dist((x, y), (table.x, table.y)) < 0.3
        assert z == pytest.approx(table.height + 0.05, abs=0.01)
    for item in stage.kept:
        pose = item.shelf_pose
        if item.name in delivered:
            continue
        assert stage.position(item.name) == pytest.approx([pose.x, pose.y, pose.z], abs=1e-3)


def test_a_wrong_medicine_is_found_put_down_and_collected_again():
    stage = Stage(wrong_items=["med_analgesic"])
    stage.stand_at(NORTH)
    charge = stage.output(stage.battery, "charge")[0]
    assert stage.do("collect_med_antibiotic")[0] is Outcome.SUCCESS
    assert stage.do("check_medication_correct")[0] is Outcome.SUCCESS
    assert "correct-medication" not in stage.facts()
    assert stage.do("check_medication_wrong")[0] is Outcome.SUCCESS
    assert "wrong-medication" in stage.facts()
    assert stage.do("put_down_medicine")[0] is Outcome.SUCCESS
    assert stage.facts() == set()
    assert stage.position(f"{NORTH}/med_analgesic")[2] == pytest.approx(LEDGE_HEIGHT + 0.05, abs=0.01)
    outcome, seconds = stage.do("collect_med_antibiotic")
    assert outcome is Outcome.SUCCESS
    assert seconds == pytest.approx(5.0, abs=0.6)
    assert stage.do("check_medication_correct")[0] is Outcome.SUCCESS
    assert stage.facts() == {"has-medication", "medication-is", "correct-medication"}
    used = charge - stage.output(stage.battery, "charge")[0]
    assert used == pytest.approx(0.05 + 0.02 + 0.02 + 0.05 + 0.05 + 0.02, abs=1e-3)


PUT_BACK = [
    (place, kind, arrival)
    for place, kind in (
        (NORTH, "med_antibiotic"),
        ("pharmacy_south", "med_antibiotic"),
        (SUPPLY, "supp_vitamin_d"),
        ("supply_B", "supp_vitamin_d"),
    )
    for arrival in (
        (0.0, 0.0, 0.0),
        *((0.15 * math.cos(angle), 0.15 * math.sin(angle), 0.2) for angle in (0.5, 2.5)),
        *((0.15 * math.cos(angle), 0.15 * math.sin(angle), -0.2) for angle in (1.5, 3.5, 5.5)),
    )
]
QUICK = {(NORTH, (0.0, 0.0, 0.0)), (SUPPLY, PUT_BACK[3][2])}


@pytest.mark.parametrize(
    ("place", "kind", "arrival"),
    [
        pytest.param(*case, marks=() if (case[0], case[2]) in QUICK else pytest.mark.slow, id=f"{case[0]}-{i % 6}")
        for i, case in enumerate(PUT_BACK)
    ],
)
def test_the_other_box_stays_in_the_gripper_while_wrong_ones_are_put_back(place, kind, arrival):
    """Wherever a leg ends, both wrong kinds come first, and no collect after a put-down upsets the shelf."""
    items = {item.name: item for item in all_items(LoadWard(), ("medication",))}
    wrong = [item.kind for item in items.values() if item.place == place and item.kind != kind]
    stage, is_medicine = Stage(wrong_items=wrong), kind.startswith("med_")
    other_place, other_kind = ("supply_A", "supp_vitamin_d") if is_medicine else (NORTH, "med_antibiotic")
    other = f"{other_place}/{other_kind}"
    stage.stand_at(other_place)
    assert stage.do(f"collect_{other_kind}")[0] is Outcome.SUCCESS
    stage.stand_at(place, *arrival)
    for handed in (*wrong, kind):
        assert stage.do(f"collect_{kind}")[0] is Outcome.SUCCESS
        assert {item for item, _ in stage.output(stage.executor, "magnet").held} == {other, f"{place}/{handed}"}
        outcome, seconds = stage.do("put_down_medicine" if is_medicine else "put_down_supplement")
        assert outcome is Outcome.SUCCESS
        assert seconds <= 5.0
        held = ((other, 1 if is_medicine else 0),)
        assert stage.output(stage.executor, "magnet").held == held
        stage.simulator.AdvanceTo(stage.context.get_time() + 2.0)
        assert math.dist(stage.position(other), stage.hanging(held[0][1])) < 0.015
        for item in items.values():
            if item.name != other:
                pose = item.shelf_pose
                assert stage.position(item.name) == pytest.approx([pose.x, pose.y, pose.z], abs=2e-3), item.name


def test_a_box_from_elsewhere_is_put_where_it_is_in_nobodys_way():
    stage = Stage()
    for place, name in ((SUPPLY, "collect_supp_vitamin_d"), (NORTH, "collect_med_insulin")):
        stage.stand_at(place)
        assert stage.do(name)[0] is Outcome.SUCCESS
    stage.stand_at("pharmacy_south", 0.05, -0.05, 0.1)
    assert stage.do("put_down_medicine")[0] is Outcome.SUCCESS
    left_there = stage.position(f"{NORTH}/med_insulin")
    assert left_there[2] == pytest.approx(LEDGE_HEIGHT + 0.05, abs=0.01)
    assert stage.do("collect_med_antibiotic")[0] is Outcome.SUCCESS
    held = {item for item, _ in stage.output(stage.executor, "magnet").held}
    assert held == {"supply_A/supp_vitamin_d", "pharmacy_south/med_antibiotic"}
    assert stage.position(f"{NORTH}/med_insulin") == pytest.approx(left_there, abs=1e-3)


def test_a_box_taken_away_is_not_there():
    stage = Stage()
    stage.stand_at(NORTH)
    body = stage.items.body(f"{NORTH}/med_antibiotic")
    stage.action.GetMutableData().set_value(Action(1, ActionKind.IN_PLACE, "collect_med_antibiotic", (), NORTH, NORTH))
    stage.sequence = 1
    stage.simulator.AdvanceTo(stage.context.get_time() + 2.5)
    stage.plant.SetFreeBodyPose(stage.plant_context, body, RigidTransform([5.0, 10.0, 0.05]))
    stage.simulator.AdvanceTo(stage.context.get_time() + 4.0)
    assert stage.output(stage.executor, "in_place_report").outcome is Outcome.NOT_THERE
    assert stage.facts() == set()


@pytest.mark.slow
def test_the_battery_is_recharged_at_the_charger():
    stage = Stage()
    stage.stand_at("charge_main")
    outcome, seconds = stage.do("recharge")
    assert outcome is Outcome.SUCCESS
    assert seconds == pytest.approx(30.0, abs=0.3)
    assert stage.output(stage.battery, "charge")[0] == pytest.approx(1.0, abs=1e-3)
