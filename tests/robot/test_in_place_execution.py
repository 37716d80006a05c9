"""What is done in place with boxes of medicine: what succeeds, what it takes, and every way in which it ends."""

import math

import pytest

import mala_drake.robot.in_place_execution as mut
from mala_drake.clock import TICK
from mala_drake.messages import ActionKind, ArmCommand, Outcome
from mala_drake.robot.arm_kinematics import STOWED
from mala_drake.ward.in_place_actions import SECONDS, Verb

from .puppet import MEDICINE, SUPPLEMENT, Puppet


@pytest.fixture
def puppet(ward):
    return Puppet(ward)


def test_a_box_is_collected_and_stays_in_the_gripper(puppet):
    puppet.load()
    assert puppet.execution.held == ((MEDICINE, 0), (SUPPLEMENT, 1))
    assert puppet.execution.arm == ArmCommand()
    puppet.stand_at("home")
    puppet.begin("go_to_home", "home", kind=ActionKind.MOVE)
    assert puppet.execution.held == ((MEDICINE, 0), (SUPPLEMENT, 1))


@pytest.mark.parametrize(
    ("name", "verb"),
    [
        ("collect_med_antibiotic", Verb.COLLECT),
        ("check_medication_correct", Verb.CHECK),
        ("put_down_supplement", Verb.PUT_DOWN),
    ],
)
def test_an_action_takes_its_time_and_its_charge(puppet, name, verb):
    if verb is not Verb.COLLECT:
        puppet.load()
    puppet.stand_at("pharmacy_north")
    time, charge = puppet.time, puppet.charge
    assert puppet.do(name, "pharmacy_north", MEDICINE) is Outcome.SUCCESS
    assert puppet.time - time == pytest.approx(SECONDS[verb])
    assert charge - puppet.charge == pytest.approx({"collect": 0.05, "check": 0.02, "put_down": 0.05}[verb.value])
    assert puppet.execution.draw == 0.0
    assert puppet.execution.steps == round(SECONDS[verb] / TICK)


def test_a_slow_arm_is_waited_for_at_no_further_cost(puppet):
    puppet.stand_at("pharmacy_north")
    puppet.begin("collect_med_antibiotic", "pharmacy_north")
    puppet.hand(MEDICINE)
    charge = puppet.charge
    for _ in range(15):
        puppet.tick()
        puppet.joints = STOWED  # The arm has not moved yet, 3 s after the beginning.
    assert puppet.execution.held == ()
    assert puppet.finish() is Outcome.SUCCESS
    assert SECONDS[Verb.COLLECT] < puppet.time < SECONDS[Verb.COLLECT] + 2.0
    assert charge - puppet.charge == pytest.approx(0.05)


def test_an_arm_that_never_comes_is_not_waited_for_for_ever(puppet):
    puppet.stand_at("pharmacy_north")
    puppet.begin("collect_med_antibiotic", "pharmacy_north")
    puppet.hand(MEDICINE)
    puppet.slippery = {MEDICINE}
    while puppet.execution.running and puppet.time < 60.0:
        puppet.tick()
        puppet.joints = STOWED
    assert puppet.execution.outcome is Outcome.NOT_THERE
    assert puppet.time < 12.0


def test_a_box_that_slips_is_not_there_and_no_longer_wanted(puppet):
    puppet.stand_at("pharmacy_north")
    puppet.slippery = {MEDICINE}
    assert puppet.do("collect_med_antibiotic", "pharmacy_north", MEDICINE) is Outcome.NOT_THERE
    assert MEDICINE in puppet.execution.detail
    assert puppet.execution.held == ()


def test_an_empty_dispenser_is_out_of_stock(puppet):
    puppet.stand_at("pharmacy_north")
    assert puppet.do("collect_med_antibiotic", "pharmacy_north", "") is Outcome.OUT_OF_STOCK
    assert puppet.time < 1.0


def test_a_dispenser_that_does_not_answer_is_given_up(puppet):
    puppet.stand_at("pharmacy_north")
    assert puppet.do("collect_med_antibiotic", "pharmacy_north") is Outcome.NOT_THERE
    assert "does not answer" in puppet.execution.detail
    assert puppet.time < 3.0


def test_what_is_too_far_away_is_out_of_reach(puppet):
    puppet.stand_at("home")
    assert puppet.do("collect_med_antibiotic", "pharmacy_north", MEDICINE) is Outcome.OUT_OF_REACH
    puppet.load()
    puppet.stand_at("home")
    for name, place in (
        ("put_down_medicine", "pharmacy_north"),
        ("put_down_medicine", "home"),
        ("deliver_on_bedside_table_left", "patient_bed_left"),
        ("deliver_on_bedside_table_left", ""),
    ):
        assert puppet.do(name, place) is Outcome.OUT_OF_REACH
        assert puppet.execution.detail
    assert puppet.execution.held == ((MEDICINE, 0), (SUPPLEMENT, 1))


@pytest.mark.parametrize(
    ("name", "place", "item"),
    [
        ("collect_med_antibiotic", "pharmacy_north", MEDICINE),
        ("recharge", "charge_main", None),
        ("deliver_on_bedside_table_left", "patient_bed_left", None),
    ],
)
@pytest.mark.parametrize(("ahead", "aside"), [(-1.2, 0.0), (-0.4, 1.1), (0.1, -1.3)])
def test_what_is_missing_of_the_arm_is_what_the_robot_has_to_move(puppet, name, place, item, ahead, aside):
    if name.startswith("deliver"):
        puppet.load()
    here = puppet.ward.place[place]
    cosine, sine = math.cos(here.yaw), math.sin(here.yaw)
    x, y = here.x + ahead * cosine - aside * sine, here.y + ahead * sine + aside * cosine

    def do_after_moving(by):
        puppet.base = (x + by * dx, y + by * dy, here.yaw)
        puppet.carry()
        return puppet.do(name, place, item)

    dx = dy = 0.0
    assert do_after_moving(0.0) is Outcome.OUT_OF_REACH
    dx, dy = puppet.execution.shortfall
    off = 0.02 / math.hypot(dx, dy)
    assert do_after_moving(1.0 - off) is Outcome.OUT_OF_REACH
    assert do_after_moving(1.0 + off) is Outcome.SUCCESS
    assert puppet.execution.shortfall is None


def test_of_a_place_without_anything_to_reach_nothing_is_missing(puppet):
    puppet.load()
    puppet.stand_at("home")
    assert puppet.do("deliver_on_bedside_table_left", "") is Outcome.OUT_OF_REACH
    assert puppet.execution.shortfall is None


def test_a_full_pad_takes_no_second_box(puppet):
    puppet.load()
    puppet.stand_at("pharmacy_north")
    other = "pharmacy_north/med_insulin"
    assert puppet.do("collect_med_insulin", "pharmacy_north", other) is Outcome.NOT_THERE
    assert puppet.execution.held == ((MEDICINE, 0), (SUPPLEMENT, 1))


@pytest.mark.parametrize("name", ["check_medication_correct", "put_down_medicine", "deliver_on_bedside_table_left"])
def test_an_empty_gripper_has_nothing_to_work_with(puppet, name):
    puppet.stand_at("pharmacy_north")
    assert puppet.do(name, "pharmacy_north") is Outcome.NOT_THERE
    assert "no medication" in puppet.execution.detail


def test_half_a_delivery_is_not_begun(puppet):
    puppet.stand_at("pharmacy_north")
    puppet.do("collect_med_antibiotic", "pharmacy_north", MEDICINE)
    puppet.stand_at("patient_bed_left")
    assert puppet.do("deliver_on_bedside_table_left", "patient_bed_left") is Outcome.NOT_THERE
    assert puppet.execution.held == ((MEDICINE, 0),)


def test_a_box_is_put_down_on_the_ledge_clear_of_the_others(puppet, ward):
    puppet.load()
    puppet.stand_at("pharmacy_north")
    assert puppet.do("put_down_medicine", "pharmacy_north") is Outcome.SUCCESS
    assert puppet.execution.held == ((SUPPLEMENT, 1),)
    position = puppet.positions[MEDICINE]
    assert position[2] == pytest.approx(0.83, abs=0.01)
    for other, at in puppet.positions.items():
        assert other == MEDICINE or math.dist(at, position) > 0.08


def test_a_box_that_does_not_stay_where_it_was_put_is_told(puppet):
    puppet.load()
    puppet.stand_at("pharmacy_north")
    puppet.begin("put_down_medicine", "pharmacy_north")
    while puppet.execution.held != ((SUPPLEMENT, 1),):
        puppet.tick()
    x, y, _ = puppet.positions[MEDICINE]
    puppet.positions[MEDICINE] = (x, y, 0.05)
    assert puppet.finish() is Outcome.NOT_THERE
    assert "where it was put" in puppet.execution.detail


@pytest.mark.parametrize("side", ["left", "right"])
def test_both_boxes_come_onto_the_bedside_table(puppet, ward, side):
    puppet.load()
    place = f"patient_bed_{side}"
    puppet.stand_at(place)
    assert puppet.do(f"deliver_on_bedside_table_{side}", place) is Outcome.SUCCESS
    assert puppet.execution.held == ()
    table = ward.furniture_of[place]
    for item in (MEDICINE, SUPPLEMENT):
        assert puppet.positions[item][2] == pytest.approx(table.height + 0.05, abs=0.01)
        assert math.dist(puppet.positions[item][:2], (table.x, table.y)) < 0.3


def test_a_second_delivery_finds_room_beside_the_first(puppet, ward):
    for medicine, supplement in ((MEDICINE, SUPPLEMENT), ("pharmacy_south/med_antibiotic", "supply_B/supp_vitamin_d")):
        puppet.stand_at("pharmacy_" + ("north" if medicine == MEDICINE else "south"))
        puppet.do("collect_med_antibiotic", "", medicine)
        puppet.stand_at("supply_" + ("A" if supplement == SUPPLEMENT else "B"))
        puppet.do("collect_supp_vitamin_d", "", supplement)
        puppet.stand_at("patient_bed_right")
        assert puppet.do("deliver_on_bedside_table_right", "patient_bed_right") is Outcome.SUCCESS


def test_recharging_fills_the_battery_in_its_time(puppet):
    puppet.charge = 0.12
    puppet.stand_at("charge_main")
    assert puppet.do("recharge", "charge_main") is Outcome.SUCCESS
    assert puppet.time == pytest.approx(SECONDS[Verb.RECHARGE])
    assert puppet.charge >= mut.FULL
    assert puppet.execution.charging == 0.0


def test_an_empty_robot_at_a_charger_can_be_recharged(puppet):
    puppet.charge = 0.0
    puppet.stand_at("charge_main")
    assert puppet.do("recharge", "charge_main") is Outcome.SUCCESS


@pytest.mark.parametrize("place", ["charge_main", "home", ""])
def test_without_a_charger_nothing_is_recharged(puppet, place):
    puppet.stand_at("home")
    assert puppet.do("recharge", place) is Outcome.OUT_OF_REACH
    assert puppet.execution.charging == 0.0


def test_an_empty_battery_ends_the_action(puppet):
    puppet.stand_at("pharmacy_north")
    puppet.begin("collect_med_antibiotic", "pharmacy_north")
    puppet.hand(MEDICINE)
    puppet.charge = 0.0
    assert puppet.finish() is Outcome.BATTERY_EMPTY
    assert puppet.execution.draw == 0.0


@pytest.mark.parametrize("early", [True, False])
def test_a_state_that_is_not_finite_ends_the_action(puppet, early):
    puppet.stand_at("pharmacy_north")
    if early:
        puppet.base = (math.nan, 0.0, 0.0)
    puppet.begin("collect_med_antibiotic", "pharmacy_north")
    puppet.base = (math.nan, 0.0, 0.0)
    assert puppet.finish() is Outcome.INVALID_STATE


def test_an_action_that_nobody_knows_is_refused(puppet):
    assert puppet.begin("juggle", "home").outcome is Outcome.NOT_THERE
    assert "(juggle robot1)" in puppet.execution.detail


def test_a_newer_action_replaces_a_running_one(puppet):
    puppet.load()
    puppet.stand_at("pharmacy_north")
    puppet.begin("put_down_medicine", "pharmacy_north")
    puppet.tick()
    replaced = puppet.begin("check_medication_correct", "pharmacy_north")
    assert (replaced.action.sequence, replaced.outcome) == (puppet.sequence, Outcome.RUNNING)
    assert puppet.finish() is Outcome.SUCCESS
    assert puppet.execution.held == ((MEDICINE, 0), (SUPPLEMENT, 1))


def test_a_leg_cancels_what_is_done_in_place(puppet):
    puppet.load()
    puppet.stand_at("pharmacy_north")
    puppet.begin("put_down_medicine", "pharmacy_north")
    puppet.tick()
    sequence = puppet.sequence
    cancelled = puppet.begin("go_to_home", "home", kind=ActionKind.MOVE)
    assert (cancelled.action.sequence, cancelled.outcome) == (sequence, Outcome.CANCELLED)
    assert cancelled.newest == puppet.sequence
    assert cancelled.arm == ArmCommand()
    assert puppet.tick() is cancelled


def test_a_leg_leaves_the_last_report_as_it_is(puppet):
    puppet.stand_at("pharmacy_north")
    puppet.do("collect_med_antibiotic", "pharmacy_north", MEDICINE)
    assert puppet.begin("go_to_home", "home", kind=ActionKind.MOVE).outcome is Outcome.SUCCESS


def test_the_arm_keeps_one_target_a_phase(puppet):
    puppet.stand_at("pharmacy_north")
    puppet.begin("collect_med_antibiotic", "pharmacy_north")
    puppet.hand(MEDICINE)
    targets = []
    while puppet.execution.running:
        x, y, yaw = puppet.base
        puppet.base = (x + 1e-4, y, yaw)  # The estimate trembles.
        puppet.tick()
        if not targets or targets[-1] != puppet.execution.arm:
            targets.append(puppet.execution.arm)
    assert len(targets) <= 6
