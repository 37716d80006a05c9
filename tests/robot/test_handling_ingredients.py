"""World, executor, arm and magnet together on the plant: a meal's boxes are collected, kept all along, and served."""

import math

import pytest
from pydrake.math import RigidTransform

from mala_drake.messages import Outcome
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.in_place_actions import SECONDS, Verb, in_place_action
from mala_drake.ward.items import ITEM_HALF_HEIGHT

from .stage import Stage

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
    stage = Stage(task="meal")
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
