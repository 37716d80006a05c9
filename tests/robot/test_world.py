import math

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.robot.world as mut
from mala_drake.clock import TICK
from mala_drake.errors import BadInput
from mala_drake.messages import Action, ActionKind, ActionReport, MagnetCommand, Outcome, Task
from mala_drake.robot.arm_kinematics import STOWED
from mala_drake.robot.gripper_geometry import hanging_positions
from mala_drake.robot.plant_state import PLANT_STATE_SIZE, QW, QZ, X, Y
from mala_drake.ward.items import all_items

BASE = (5.0, 18.0, math.pi / 2)
HANGING = hanging_positions(BASE, STOWED)
ANTIBIOTIC, VITAMIN = "pharmacy_north/med_antibiotic", "supply_A/supp_vitamin_d"


class Stage:
    """A world whose inputs are in the test's hands; the robot stands at the north pharmacy, its arm stowed."""

    def __init__(self, ward, *, episode=0, **options):
        items = options.setdefault("items", all_items(ward, ("medication",)))
        self.names = [item.name for item in items]
        self.positions = np.array([[i.shelf_pose.x, i.shelf_pose.y, i.shelf_pose.z] for i in items], dtype=float)
        self.world = mut.World(ward, **options)
        self.simulator = Simulator(self.world)
        self.context = self.simulator.get_mutable_context()
        self.sequence = 0
        self.task = self._fix("task", Value(Task(1, "medication", episode)))
        self.action = self._fix("action", Value(Action()))
        self.magnet = self._fix("magnet", Value(MagnetCommand()))
        self.report = self._fix("in_place_report", Value(ActionReport()))
        self.item_positions = self._fix("item_positions", self.positions.ravel())
        state = np.zeros(PLANT_STATE_SIZE)
        state[[QW, QZ, X, Y]] = math.cos(BASE[2] / 2), math.sin(BASE[2] / 2), BASE[0], BASE[1]
        self.plant_state = self._fix("plant_state", state)
        self._fix("arm_state", [*STOWED, 0.0, 0.0, 0.0])

    def _fix(self, name, value):
        return self.world.GetInputPort(name).FixValue(self.context, value)

    def output(self, name):
        return self.world.GetOutputPort(name).Eval(self.context)

    def tick(self):
        self.simulator.AdvanceTo(self.context.get_time() + TICK)

    def place(self, item, position):
        self.positions[self.names.index(item)] = position
        self.item_positions.GetMutableData().get_mutable_value().SetFromVector(self.positions.ravel())

    def begin(self, name, place="pharmacy_north", kind=ActionKind.IN_PLACE, arguments=()):
        self.sequence += 1
        arguments = ("robot1", *arguments)
        self.action.GetMutableData().set_value(Action(self.sequence, kind, name, arguments, place, place))
        self.tick()

    def hold(self, *held):
        self.magnet.GetMutableData().set_value(MagnetCommand(held))
        for item, pad in held:
            self.place(item, HANGING[pad])
        self.tick()

    def end(self, outcome=Outcome.SUCCESS):
        self.report.GetMutableData().set_value(ActionReport(self.sequence, outcome))
        self.tick()

    def facts(self):
        """All atoms but the stock's."""
        return {atom for atom in self.output("world_facts").atoms if atom[0] != "available"}


@pytest.fixture
def make_stage(ward):
    def make(**options):
        stage = Stage(ward, **options)
        stage.tick()
        return stage

    return make


def test_drawn_ports_are_the_real_ports(ward, assert_port_box):
    assert_port_box(mut.World(ward))


def test_at_first_everything_is_in_its_dispenser(make_stage, ward):
    stage = make_stage()
    assert [name for name, _ in stage.output("clamped").items] == stage.names
    items = all_items(ward, ("medication",))
    assert dict(stage.output("clamped").items) == {item.name: item.shelf_pose for item in items}
    assert len(stage.output("world_facts").atoms) == 12
    assert stage.output("handed_item").sequence == 0


def test_a_box_is_handed_over_then_taken_then_believed(make_stage):
    stage = make_stage()
    stage.begin("collect_med_antibiotic")
    handed = stage.output("handed_item")
    assert (handed.sequence, handed.item) == (1, ANTIBIOTIC)
    assert ANTIBIOTIC in dict(stage.output("clamped").items)
    stage.hold((ANTIBIOTIC, 0))
    assert ANTIBIOTIC not in dict(stage.output("clamped").items)
    assert stage.facts() == set()
    stage.end()
    assert stage.facts() == {("has-medication", "robot1"), ("medication-is", "robot1", "med_antibiotic")}
    assert stage.output("world_facts").sequence == 1
    assert ("available", "med_antibiotic", "pharmacy_north") not in stage.output("world_facts").atoms


def test_the_wrong_box_looks_right_until_it_is_checked(make_stage):
    stage = make_stage(wrong_items=["med_insulin"])
    stage.begin("collect_med_antibiotic")
    assert stage.output("handed_item").item == "pharmacy_north/med_insulin"
    stage.hold(("pharmacy_north/med_insulin", 0))
    stage.end()
    assert ("medication-is", "robot1", "med_antibiotic") in stage.facts()
    stage.begin("check_medication_correct")
    stage.end()
    assert stage.facts() == {("has-medication", "robot1"), ("medication-is", "robot1", "med_insulin")}
    stage.begin("check_medication_wrong")
    stage.end()
    assert ("wrong-medication", "robot1") in stage.facts()
    stage.begin("put_down_medicine")
    stage.hold()
    stage.end()
    assert stage.facts() == set()
    stage.begin("collect_med_antibiotic")
    assert stage.output("handed_item").item == ANTIBIOTIC


def test_a_box_that_falls_on_the_way_is_missed(make_stage):
    stage = make_stage()
    stage.begin("collect_med_antibiotic")
    stage.hold((ANTIBIOTIC, 0))
    stage.end()
    stage.place(ANTIBIOTIC, (5.0, 17.0, 0.05))
    stage.tick()
    assert stage.facts() == set()


def test_an_empty_dispenser_says_so(make_stage):
    stage = make_stage()
    stage.begin("collect_med_antibiotic", place="supply_A")
    handed = stage.output("handed_item")
    assert (handed.sequence, handed.item) == (1, "")


def deliver(stage, ward, *, second_height=0.0):
    stage.hold((ANTIBIOTIC, 0), (VITAMIN, 1))
    stage.begin("deliver_on_bedside_table_left", place="patient_bed_left")
    table = ward.furniture_of["patient_bed_left"]
    stage.magnet.GetMutableData().set_value(MagnetCommand())
    stage.place(ANTIBIOTIC, (table.x, table.y, table.height + 0.05))
    stage.place(VITAMIN, (table.x + 0.05, table.y + 0.05, table.height + 0.05 + second_height))
    stage.end()


def test_two_boxes_resting_on_the_bedside_table_are_delivered(make_stage, ward):
    stage = make_stage()
    deliver(stage, ward)
    assert stage.facts() == {("delivered", "robot1")}


@pytest.mark.parametrize("height", [-0.7, 0.05, math.nan])
def test_a_box_beside_the_table_is_not_delivered(make_stage, ward, height):
    stage = make_stage()
    deliver(stage, ward, second_height=height)
    assert stage.facts() == set()


def test_the_next_task_begins_with_nothing_delivered(make_stage, ward):
    stage = make_stage()
    deliver(stage, ward)
    stage.task.GetMutableData().set_value(Task(2, "medication", 1))
    stage.tick()
    assert stage.facts() == set()


def test_an_action_that_is_replaced_has_the_effects_that_are_there(make_stage):
    stage = make_stage()
    stage.begin("collect_med_antibiotic")
    stage.hold((ANTIBIOTIC, 0))
    stage.begin("go_to_supply_a", kind=ActionKind.MOVE)
    assert stage.facts() == {("has-medication", "robot1"), ("medication-is", "robot1", "med_antibiotic")}
    assert stage.output("world_facts").sequence == 1


def test_a_check_that_is_replaced_establishes_nothing(make_stage):
    stage = make_stage()
    stage.begin("collect_med_antibiotic")
    stage.hold((ANTIBIOTIC, 0))
    stage.end()
    stage.begin("check_medication_correct")
    stage.begin("go_to_supply_a", kind=ActionKind.MOVE)
    assert ("correct-medication", "robot1") not in stage.facts()


def handed_over(make_stage, *, seed, episode, count=3):
    """The boxes that the first collect actions of an episode get, with even chances of a wrong one."""
    stage = make_stage(seed=seed, episode=episode, wrong_item_probability=0.5)
    found = []
    for _ in range(count):
        stage.begin("collect_med_antibiotic")
        found.append(stage.output("handed_item").item)
    return tuple(found)


def test_the_same_episode_goes_the_same_way_again(make_stage):
    assert handed_over(make_stage, seed=3, episode=5) == handed_over(make_stage, seed=3, episode=5)


def test_seeds_and_episodes_go_different_ways(make_stage):
    assert len({handed_over(make_stage, seed=seed, episode=0) for seed in range(8)}) > 2
    assert len({handed_over(make_stage, seed=0, episode=episode) for episode in range(8)}) > 2


def test_the_message_to_the_magnet_is_the_same_object_while_nothing_is_taken(make_stage):
    stage = make_stage()
    before = stage.output("clamped")
    stage.tick()
    assert stage.output("clamped") is before


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"wrong_item_probability": 1.5}, "wrong_item_probability: 1.5; expected a number in [0, 1]"),
        ({"wrong_item_probability": math.nan}, "wrong_item_probability: nan"),
        ({"wrong_items": ["med_aspirin"]}, "wrong_items[0]: 'med_aspirin'; expected one of med_antibiotic"),
        ({"requested": {"medication": "med_insulin"}}, "requested.supplement: None; expected one of supp_vitamin_d"),
        (
            {"requested": {"medication": "supp_omega3", "supplement": "supp_omega3"}},
            "requested.medication: 'supp_omega3'; expected one of med_antibiotic",
        ),
        ({"requested": {"meal": "soup"}}, "requested.meal: unknown key; expected one of medication, supplement"),
        ({"seed": -1}, "seed: -1"),
    ],
)
def test_bad_options_are_told_in_one_line(ward, options, told):
    with pytest.raises(BadInput) as error:
        mut.World(ward, **options)
    assert told in str(error.value)


def test_another_request_makes_another_box_correct(make_stage):
    stage = make_stage(requested={"medication": "med_insulin", "supplement": "supp_omega3"})
    stage.begin("collect_med_insulin")
    stage.hold(("pharmacy_north/med_insulin", 0))
    stage.end()
    stage.begin("check_medication_correct")
    stage.end()
    assert ("correct-medication", "robot1") in stage.facts()


@pytest.fixture
def kitchen(ward, make_stage):
    """A world with a kitchen in which a salad has been chosen and collected."""
    stage = make_stage(items=all_items(ward, ("meal",)), wrong_item_probability=1.0)
    stage.begin("choose_salad", "home")
    stage.end()
    for pad, kind in enumerate(("nuts", "vegetables")):
        stage.begin("collect_ingredient", "pantry", arguments=("pantry", kind))
        assert stage.output("handed_item").item == f"pantry/{kind}"
        stage.hold(*((f"pantry/{each}", i) for i, each in enumerate(("nuts", "vegetables")[: pad + 1])))
        stage.end()
    return stage


def predicates(stage):
    return {atom[0] for atom in stage.output("world_facts").atoms}


def test_ingredients_are_collected_as_they_are_and_leave_the_stock(kitchen):
    facts = kitchen.output("world_facts").atoms
    assert ("collected_ingredient", "robot1", "nuts") in facts
    assert ("collected_ingredient", "robot1", "vegetables") in facts
    assert ("ingredient_available", "nuts", "pantry") not in facts
    assert ("ingredient_available", "vegetables", "pantry") in facts  # The one in reserve.
    assert "missing_ingredient" not in predicates(kitchen)


def test_what_is_done_to_a_meal_is_established_when_it_has_succeeded(kitchen):
    kitchen.begin("check_ingredients", "prep_station", arguments=("salad",))
    assert "ingredients_checked" not in predicates(kitchen)
    kitchen.end()
    assert {"ingredients_checked", "ingredients_safe"} <= predicates(kitchen)
    kitchen.begin("wash_ingredients", "prep_station")
    kitchen.end(Outcome.NOT_THERE)
    assert "ingredients_washed" not in predicates(kitchen)


def test_an_ingredient_lost_on_the_way_is_missed_with_all_that_was_done_to_it(kitchen):
    kitchen.begin("check_ingredients", "prep_station", arguments=("salad",))
    kitchen.end()
    kitchen.place("pantry/nuts", (0.0, 18.0, 0.05))
    kitchen.tick()
    assert ("missing_ingredient", "robot1", "nuts") in kitchen.output("world_facts").atoms
    assert "ingredients_checked" not in predicates(kitchen)


def test_an_ingredient_out_of_stock_is_not_handed_over(kitchen):
    kitchen.hold(("pantry/vegetables", 1))
    kitchen.begin("collect_ingredient", "pantry", arguments=("pantry", "nuts"))
    assert kitchen.output("handed_item").item == ""


def test_a_finished_meal_can_be_delivered_at_a_bedside_only(kitchen, ward):
    for name in ("check_palatability", "assemble"):
        kitchen.begin(name, "quality_check", arguments=("salad",))
        kitchen.end()
    assert "can_be_deliverable" not in predicates(kitchen)
    bed = ward.place["patient_bed_left"]
    state = kitchen.plant_state.GetMutableData().get_mutable_value()
    moved = state.get_value().copy()
    moved[[X, Y]] = bed.x, bed.y
    moved[[QW, QZ]] = 1.0, 0.0
    state.SetFromVector(moved)
    hanging = hanging_positions((bed.x, bed.y, 0.0), STOWED)
    for pad, kind in enumerate(("nuts", "vegetables")):
        kitchen.place(f"pantry/{kind}", hanging[pad])
    kitchen.tick()
    assert "can_be_deliverable" in predicates(kitchen)


def test_the_next_task_begins_with_no_dish(kitchen):
    kitchen.task.GetMutableData().set_value(Task(2, "meal", 1))
    kitchen.tick()
    assert "meal_to_prepare" not in predicates(kitchen)
    assert "cross-contamination-risk" in predicates(kitchen)
