import math

import pytest

import mala_drake.robot.in_place_execution as mut
from mala_drake.clock import TICK
from mala_drake.messages import Action, ActionKind, ArmCommand, Outcome
from mala_drake.robot.arm_kinematics import STOWED, joints_for_gripper
from mala_drake.robot.gripper_geometry import hanging_positions
from mala_drake.robot.item_messages import HandedItem
from mala_drake.ward.in_place_actions import SECONDS, Verb
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import LoadWard

MEDICINE, SUPPLEMENT = "pharmacy_north/med_antibiotic", "supply_A/supp_vitamin_d"


@pytest.fixture(scope="module")
def ward():
    return LoadWard()


class Puppet:
    """An ideal robot: the arm is where it is told at the next tick, what the magnet wants hangs there at once."""

    def __init__(self, ward):
        self.ward = ward
        self.time = 0.0
        self.base = (0.0, 0.0, 0.0)
        self.joints = STOWED
        self.positions = {i.name: (i.shelf_pose.x, i.shelf_pose.y, i.shelf_pose.z) for i in all_items(ward)}
        self.charge = 0.8
        self.handed = HandedItem()
        self.slippery = set()  # Boxes that the magnet does not hold.
        self.execution = mut.Execution()
        self.sequence = 0

    def stand_at(self, place):
        here = self.ward.place[place]
        self.base = (here.x, here.y, here.yaw)
        self.carry()

    def carry(self):
        for item, pad in self.execution.held:
            if item not in self.slippery:
                self.positions[item] = hanging_positions(self.base, self.joints)[pad]

    def senses(self):
        return mut.Senses(self.time, self.base, self.joints, dict(self.positions), self.charge, self.handed)

    def begin(self, name, place, kind=ActionKind.IN_PLACE, arguments=()):
        self.sequence += 1
        action = Action(self.sequence, kind, name, ("robot1", *arguments), place, place)
        self.execution = mut.accept(self.execution, action, self.senses(), self.ward)
        return self.execution

    def hand(self, item):
        self.handed = HandedItem(self.sequence, item)

    def tick(self):
        self.time += TICK
        self.charge += TICK * (self.execution.charging - self.execution.draw)
        self.execution = mut.advance(self.execution, self.senses())
        p_BG = self.execution.arm.p_BG
        self.joints = STOWED if p_BG is None else joints_for_gripper(p_BG)
        self.carry()
        return self.execution

    def finish(self, limit=60.0):
        begun = self.time
        while self.execution.running and self.time - begun < limit:
            self.tick()
        return self.execution.outcome

    def do(self, name, place, item=None, arguments=()):
        self.begin(name, place, arguments=arguments)
        if item is not None:
            self.hand(item)
        return self.finish()

    def load(self):
        """Collects a medicine and a supplement."""
        self.stand_at("pharmacy_north")
        assert self.do("collect_med_antibiotic", "pharmacy_north", MEDICINE) is Outcome.SUCCESS
        self.stand_at("supply_A")
        assert self.do("collect_supp_vitamin_d", "supply_A", SUPPLEMENT) is Outcome.SUCCESS


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


class Cook(Puppet):
    """An ideal robot with the ingredients of a salad in its gripper."""

    def __init__(self, ward):
        super().__init__(ward)
        self.stand_at("pantry")
        for kind in ("nuts", "vegetables"):
            outcome = self.do("collect_ingredient", "pantry", f"pantry/{kind}", arguments=("pantry", kind))
            assert outcome is Outcome.SUCCESS

    def heights(self, name, place, arguments=("salad",)):
        """The heights of the gripper while an action is done."""
        self.stand_at(place)
        self.begin(name, place, arguments=arguments)
        found = []
        while self.tick().running:
            found.append(0.95 if self.execution.arm.p_BG is None else self.execution.arm.p_BG[2])
        assert self.execution.outcome is Outcome.SUCCESS
        return found


@pytest.fixture
def cook(ward):
    return Cook(ward)


PREPARATION = {
    "check_ingredients": ("prep_station", 4.0, 0.01),
    "sanitize_workspace": ("prep_station", 5.0, 0.02),
    "wash_ingredients": ("prep_station", 6.0, 0.02),
    "chop_ingredients": ("prep_station", 8.0, 0.03),
    "cook_meal": ("stove", 12.0, 0.50),
    "check_cooking_level": ("stove", 4.0, 0.01),
    "check_palatability": ("quality_check", 4.0, 0.01),
    "assemble": ("quality_check", 13.4, 0.02),
    "deliver_on_bedside_table_left": ("patient_bed_left", 10.0, 0.01),
}


@pytest.mark.parametrize("name", PREPARATION)
def test_what_is_done_to_a_meal_takes_its_time_and_its_charge(cook, name):
    place, seconds, used = PREPARATION[name]
    cook.stand_at(place)
    time, charge = cook.time, cook.charge
    assert cook.do(name, place, arguments=("salad",)) is Outcome.SUCCESS
    assert cook.time - time == pytest.approx(seconds)
    assert charge - cook.charge == pytest.approx(used)
    assert cook.execution.arm == ArmCommand()


@pytest.mark.parametrize("name", [name for name in PREPARATION if name != "deliver_on_bedside_table_left"])
def test_a_meal_that_slips_on_the_way_through_the_kitchen_is_not_prepared(cook, name):
    place = PREPARATION[name][0]
    cook.stand_at(place)
    cook.begin(name, place, arguments=("salad",))
    cook.slippery = {"pantry/vegetables"}
    cook.positions["pantry/vegetables"] = (*cook.base[:2], 0.05)
    assert cook.finish() is Outcome.NOT_THERE
    assert "pantry/vegetables" in cook.execution.detail
    assert cook.execution.held == (("pantry/nuts", 0),)


@pytest.mark.parametrize("name", PREPARATION)
def test_half_a_meal_is_not_worked_on(ward, name):
    cook = Puppet(ward)
    cook.stand_at("pantry")
    cook.do("collect_ingredient", "pantry", "pantry/vegetables", arguments=("pantry", "vegetables"))
    cook.stand_at(PREPARATION[name][0])
    assert cook.do(name, PREPARATION[name][0], arguments=("salad",)) is Outcome.NOT_THERE
    assert "no nuts" in cook.execution.detail
    assert cook.execution.held == (("pantry/vegetables", 1),)


@pytest.mark.parametrize(
    "name", ["sanitize_workspace", "wash_ingredients", "chop_ingredients", "cook_meal", "assemble"]
)
@pytest.mark.parametrize("place", ["home", "supply_A", "prep_station"])
def test_a_meal_is_prepared_at_its_counter_only(cook, name, place):
    cook.stand_at("home")
    assert cook.do(name, place, arguments=("salad",)) is Outcome.OUT_OF_REACH
    assert cook.execution.detail


def test_food_is_wiped_dipped_chopped_and_held_over_the_stove(cook):
    """The height of the gripper tells one action from the other."""

    def strokes(heights):
        low = [height < 1.0 for height in heights]
        return sum(now and not before for before, now in zip([False, *low], low, strict=False))

    ledge = 0.90  # Of a gripper whose boxes stand on the ledge.
    wash, chop = cook.heights("wash_ingredients", "prep_station"), cook.heights("chop_ingredients", "prep_station")
    assert strokes(wash) == 2  # The arm is stowed from the second dip.
    assert strokes(chop) == 3 + 1  # And once more when it is stowed.
    held_over = cook.heights("cook_meal", "stove")
    assert sum(height > ledge + 0.15 for height in held_over) > 0.7 * len(held_over)
    assert min(cook.heights("sanitize_workspace", "prep_station")) == pytest.approx(0.95)


def test_a_choice_is_a_nod_with_whatever_is_in_the_gripper(cook):
    cook.stand_at("home")
    time = cook.time
    cook.begin("choose_sandwich", "home")
    cook.tick()
    assert cook.execution.arm.p_BG is not None
    assert cook.finish() is Outcome.SUCCESS
    assert cook.time - time == pytest.approx(0.6)  # Half a second, to the next tick.
    assert cook.execution.held == (("pantry/nuts", 0), ("pantry/vegetables", 1))


def test_a_kind_whose_pad_is_taken_is_not_collected(cook):
    cook.stand_at("pantry")
    outcome = cook.do("collect_ingredient", "pantry", "pantry/vegetables_2", arguments=("pantry", "vegetables"))
    assert outcome is Outcome.NOT_THERE
    assert cook.execution.held == (("pantry/nuts", 0), ("pantry/vegetables", 1))
