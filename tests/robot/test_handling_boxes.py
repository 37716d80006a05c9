"""World, executor, arm and magnet together on the plant: boxes are really collected, put down and delivered."""

import math

import pytest
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from mala_drake.messages import Action, ActionKind, Outcome, Task
from mala_drake.robot.arm import Arm
from mala_drake.robot.arm_kinematics import PAD_OFFSETS
from mala_drake.robot.battery import Battery
from mala_drake.robot.drivetrain import Drivetrain
from mala_drake.robot.gripper_geometry import HANGING_DEPTH
from mala_drake.robot.in_place_executor import InPlaceExecutor
from mala_drake.robot.item_positions import ItemPositions
from mala_drake.robot.items import AddItems
from mala_drake.robot.magnet import Magnet
from mala_drake.robot.plant import AddCareRobot, MakeCarePlant, SetRobotPose, X_WB_at
from mala_drake.robot.state_estimator import StateEstimator
from mala_drake.robot.ward_plant import AddWard
from mala_drake.robot.world import World
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.in_place_actions import SECONDS, Verb, in_place_action
from mala_drake.ward.items import ITEM_HALF_HEIGHT, LEDGE_HEIGHT, all_items
from mala_drake.ward.ward_map import LoadWard

NORTH, SUPPLY, RIGHT = "pharmacy_north", "supply_A", "patient_bed_right"


class Ward:
    """The robot among the furniture it handles boxes at, set before one place after another by the test."""

    def __init__(self, **options):
        self.ward = LoadWard()
        self.task = options.pop("task", "medication")
        self.kept = all_items(self.ward, (self.task,))
        builder = DiagramBuilder()
        self.plant, scene_graph = MakeCarePlant(builder)
        self.robot = AddCareRobot(self.plant, scene_graph)
        AddWard(self.plant, self.ward, visible=False)
        self.items = AddItems(self.plant, scene_graph, self.kept, self.robot)
        self.plant.Finalize()
        self._wire(builder, options)
        self.diagram = builder.Build()
        self.simulator = Simulator(self.diagram)
        self.context = self.simulator.get_mutable_context()
        self.plant_context = self.plant.GetMyMutableContextFromRoot(self.context)
        self.diagram.GetInputPort("control").FixValue(self.context, [0.0, 2.0, 0.0])
        self.diagram.GetInputPort("task").FixValue(self.context, Value(Task(1, self.task)))
        self.action = self.diagram.GetInputPort("action").FixValue(self.context, Value(Action()))
        self.sequence, self.place = 0, ""

    def _wire(self, builder, options):
        self.world = World(self.ward, items=self.kept, **options)
        self.executor = InPlaceExecutor(self.ward, items=self.kept)
        self.battery = Battery(initial_charge=0.9)
        systems = [
            *(self.world, self.executor, self.battery, Drivetrain(), StateEstimator(), Arm()),
            Magnet(self.plant, self.robot, self.items),
            ItemPositions(self.plant, self.items),
        ]
        for system in systems:
            builder.AddSystem(system)
        ports = {
            "plant_state": self.plant.get_state_output_port(self.robot.robot),
            "arm_state": self.plant.get_state_output_port(self.robot.arm),
            "state": self.plant.get_state_output_port(),
        }
        for system in systems:
            for i in range(system.num_output_ports()):
                ports[system.get_output_port(i).get_name()] = system.get_output_port(i)
        for system in systems:
            for i in range(system.num_input_ports()):
                port = system.get_input_port(i)
                if port.get_name() in ports:
                    builder.Connect(ports[port.get_name()], port)
        builder.Connect(ports["wheel_torques"], self.plant.get_actuation_input_port(self.robot.robot))
        builder.Connect(ports["desired_state"], self.plant.get_desired_state_input_port(self.robot.arm))
        builder.Connect(ports["generalized_force"], self.plant.get_applied_generalized_force_input_port())
        builder.ExportInput(systems[3].GetInputPort("control"), "control")
        builder.ExportInput(self.world.GetInputPort("task"), "task")
        builder.ExportInput(self.world.GetInputPort("action"), "action")
        builder.ConnectInput("action", self.executor.GetInputPort("action"))

    def output(self, system, name):
        return system.GetOutputPort(name).Eval(system.GetMyContextFromRoot(self.context))

    def stand_at(self, place, ahead=0.0, aside=0.0, turn=0.0):
        """Sets the robot, with what hangs at it, before a place, off its standing pose by that much."""
        here, self.place = self.ward.place[place], place
        cosine, sine = math.cos(here.yaw), math.sin(here.yaw)
        x, y = here.x + ahead * cosine - aside * sine, here.y + ahead * sine + aside * cosine
        X_BW = self.plant.GetFreeBodyPose(self.plant_context, self.robot.base).inverse()
        X_WB = X_WB_at(x, y, here.yaw + turn)
        for item, _ in self.output(self.executor, "magnet").held:
            body = self.items.body(item)
            X_BI = X_BW @ self.plant.GetFreeBodyPose(self.plant_context, body)
            self.plant.SetFreeBodyPose(self.plant_context, body, X_WB @ X_BI)
        SetRobotPose(self.plant, self.plant_context, self.robot, x=x, y=y, yaw=here.yaw + turn)
        self.simulator.AdvanceTo(self.context.get_time() + 0.4)

    def do(self, name, *arguments):
        """What became of an in-place action, and how long it took."""
        self.sequence += 1
        action = Action(self.sequence, ActionKind.IN_PLACE, name, ("robot1", *arguments), self.place, self.place)
        self.action.GetMutableData().set_value(action)
        begun = self.context.get_time()
        while self.context.get_time() - begun < 60.0:
            self.simulator.AdvanceTo(self.context.get_time() + 0.2)
            report = self.output(self.executor, "in_place_report")
            if report.finished and report.sequence == self.sequence:
                break
        seconds = self.context.get_time() - begun
        self.simulator.AdvanceTo(self.context.get_time() + 0.2)
        return report.outcome, seconds

    def facts(self):
        atoms = self.output(self.world, "world_facts").atoms
        return {atom[0] for atom in atoms if atom[0] != "available"}

    def hanging(self, pad):
        """Where a box at that pad belongs, by the real pose of the gripper."""
        X_WG = self.robot.gripper.CalcPoseInWorld(self.plant_context)
        bar = self.plant.GetBodyByName("base", self.robot.robot).EvalPoseInWorld(self.plant_context).rotation()
        yaw = self.plant.get_state_output_port(self.robot.arm).Eval(self.plant_context)[0]
        along = bar.multiply([-PAD_OFFSETS[pad] * math.sin(yaw), PAD_OFFSETS[pad] * math.cos(yaw), 0.0])
        return X_WG.translation() + along - [0.0, 0.0, HANGING_DEPTH]

    def position(self, item):
        return self.plant.GetFreeBodyPose(self.plant_context, self.items.body(item)).translation()


@pytest.mark.parametrize(
    "arrival",
    [
        pytest.param((-0.1, 0.1, 0.2), id="short of the place, to its left"),
        pytest.param((0.0, 0.0, 0.0), id="exactly there", marks=pytest.mark.slow),
        pytest.param((0.1, -0.1, -0.2), id="beyond the place, to its right", marks=pytest.mark.slow),
    ],
)
def test_a_medicine_and_a_supplement_are_collected_checked_and_delivered(arrival):
    stage = Ward()
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
    stage = Ward(wrong_items=["med_analgesic"])
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
    stage, is_medicine = Ward(wrong_items=wrong), kind.startswith("med_")
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
    stage = Ward()
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
    stage = Ward()
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
    stage = Ward()
    stage.stand_at("charge_main")
    outcome, seconds = stage.do("recharge")
    assert outcome is Outcome.SUCCESS
    assert seconds == pytest.approx(30.0, abs=0.3)
    assert stage.output(stage.battery, "charge")[0] == pytest.approx(1.0, abs=1e-3)


ARRIVALS = [
    pytest.param((-0.1, 0.1, 0.2), id="short of the place, to its left"),
    pytest.param((0.0, 0.0, 0.0), id="exactly there", marks=pytest.mark.slow),
    pytest.param((0.1, -0.1, -0.2), id="beyond the place, to its right"),
]
IN_THE_KITCHEN = {
    "prep_station": ("check_ingredients", "sanitize_workspace", "wash_ingredients", "chop_ingredients"),
    "stove": ("cook_meal", "check_cooking_level"),
    "quality_check": ("check_palatability", "assemble"),
    "patient_bed_left": ("deliver_on_bedside_table_left",),
}


def cooking(arrival, dish="hot_meal"):
    """A stage on which a dish has been chosen and its ingredients collected."""
    stage = Ward(task="meal")
    stage.stand_at("home")
    assert stage.do(f"choose_{dish}")[0] is Outcome.SUCCESS
    for kind in reversed(DISHES[dish].ingredients):
        place = next(item.place for item in stage.kept if item.kind == kind)
        stage.stand_at(place, *arrival)
        outcome, seconds = stage.do("collect_ingredient", place, kind)
        assert outcome is Outcome.SUCCESS, kind
        assert seconds < SECONDS[Verb.COLLECT_INGREDIENT] + 1.5
    return stage


@pytest.mark.parametrize("arrival", ARRIVALS)
def test_a_hot_meal_is_prepared_and_served_with_its_boxes_in_the_gripper_all_the_time(arrival):
    stage = cooking(arrival)
    boxes = ("fridge/chicken", "pantry/vegetables")
    for place, names in IN_THE_KITCHEN.items():
        stage.stand_at(place, *arrival)
        for name in names:
            outcome, seconds = stage.do(name, "hot_meal")
            assert outcome is Outcome.SUCCESS, name
            assert seconds < in_place_action(name, ("hot_meal",)).seconds + 1.5, name
            if not name.startswith("deliver"):
                for pad, box in enumerate(boxes):
                    assert math.dist(stage.position(box), stage.hanging(pad)) < 0.02, name
    assert {"delivered", "meal_palatable", "meal_assembled"} <= stage.facts()
    table = stage.ward.furniture_of["patient_bed_left"]
    for box in boxes:
        x, y, z = stage.position(box)
        assert math.dist((x, y), (table.x, table.y)) < 0.3
        assert z == pytest.approx(table.height + ITEM_HALF_HEIGHT, abs=0.01)
    for item in stage.kept:
        if item.name not in boxes:
            pose = item.shelf_pose
            assert stage.position(item.name) == pytest.approx([pose.x, pose.y, pose.z], abs=2e-3), item.name


@pytest.mark.parametrize("arrival", ARRIVALS)
@pytest.mark.parametrize("dish", ["sandwich", "salad"])
def test_every_ingredient_of_the_pantry_is_taken_without_touching_the_others(arrival, dish):
    stage = cooking(arrival, dish)
    stage.simulator.AdvanceTo(stage.context.get_time() + 2.0)
    held = stage.output(stage.executor, "magnet").held
    assert [name for name, _ in held] == [f"pantry/{kind}" for kind in DISHES[dish].ingredients]
    for item in stage.kept:
        if item.name not in dict(held):
            pose = item.shelf_pose
            assert stage.position(item.name) == pytest.approx([pose.x, pose.y, pose.z], abs=2e-3), item.name


def test_an_ingredient_that_falls_while_it_is_chopped_is_noticed():
    stage = cooking((0.0, 0.0, 0.0), "salad")
    stage.stand_at("prep_station")
    body = stage.items.body("pantry/vegetables")
    pose = stage.plant.GetFreeBodyPose(stage.plant_context, body)
    stage.plant.SetFreeBodyPose(stage.plant_context, body, RigidTransform(pose.rotation(), [-1.0, 20.0, 0.3]))
    assert stage.do("chop_ingredients", "salad")[0] is Outcome.NOT_THERE
    assert {"missing_ingredient", "collected_ingredient"} <= stage.facts()
    assert "ingredients_chopped" not in stage.facts()
    # The other box of vegetables makes up for it.
    stage.stand_at("pantry")
    assert stage.do("collect_ingredient", "pantry", "vegetables")[0] is Outcome.SUCCESS
    assert dict(stage.output(stage.executor, "magnet").held) == {"pantry/nuts": 0, "pantry/vegetables_2": 1}
    assert stage.do("collect_ingredient", "pantry", "chicken")[0] is Outcome.OUT_OF_STOCK
