"""The meal domain: what it offers, and its rules."""

import pytest

from mala_drake.patient.profiles import PROFILES
from mala_drake.planning import Planner, PlanningTask
from mala_drake.ward.dishes import DISHES

from .errands import CHARGERS
from .plan_steps import at, names, possible_names, stops_of, with_charge

DOMAIN = "meal"

MOVES = {"go_to_pantry", "go_to_fridge", "go_to_prep_station", "go_to_cooking_station", "go_to_quality_check"}
MOVES |= {"go_to_charge_main", "go_to_charge_backup", "approach_to_left_side", "approach_to_right_side"}
CARE = {"choose_sandwich", "choose_salad", "choose_hot_meal", "collect_ingredient", "check_ingredients"}
CARE |= {"sanitize_workspace", "wash_ingredients", "chop_ingredients", "cook_meal", "check_cooking_level"}
CARE |= {"check_palatability", "assemble", "recharge"}
CARE |= {"deliver_on_bedside_table_left", "deliver_on_bedside_table_right"}


def preparing(dish: str, *done: str) -> list[tuple[str, ...]]:
    """The facts of a robot that holds the ingredients of a dish, with what has been done to them."""
    facts = [("meal_to_prepare", "robot1", dish)]
    facts += [("collected_ingredient", "robot1", kind) for kind in DISHES[dish].ingredients]
    return facts + [(each, "robot1") for each in done]


def test_the_domain_has_the_24_actions_of_the_paper(task: PlanningTask) -> None:
    assert {schema.name for schema in task.description.actions} == MOVES | CARE
    assert len(MOVES | CARE) == 24


def test_every_action_is_possible_in_some_state(task: PlanningTask) -> None:
    assert possible_names(task) == MOVES | CARE


def test_it_speaks_of_what_the_paper_speaks_of(task: PlanningTask) -> None:
    predicates = (
        "meal_to_prepare ingredient_available connected collected_ingredient missing_ingredient ingredients_checked "
        "ingredients_safe workspace-clean robot-hands-clean cross-contamination-risk ingredients_washed "
        "ingredients_chopped requires_cooking meal_cooked cooking_level_checked meal_palatable meal_assembled "
        "can_be_deliverable delivered at"
    )
    assert set(task.description.predicates) == set(predicates.split())


@pytest.mark.parametrize(
    ("dish", "chopped", "wanted"),
    [
        ("sandwich", (), "(go_to_quality_check robot1 prep_station)"),
        ("hot_meal", (("cross-contamination-risk",),), "(go_to_cooking_station robot1 prep_station)"),
    ],
)
def test_only_what_requires_cooking_is_cooked(
    task: PlanningTask, planner: Planner, dish: str, chopped: tuple[tuple[str, ...], ...], wanted: str
) -> None:
    done = preparing(dish, "ingredients_checked", "ingredients_safe", "ingredients_washed", "ingredients_chopped")
    initial = task.initial_state.with_facts(remove=[("cross-contamination-risk",)])
    state = at(initial, "prep_station", *done, ("robot-hands-clean", "robot1"), *chopped)
    assert planner.solve(state).actions[0] == wanted


def test_the_rules_of_hygiene(task: PlanningTask) -> None:
    """Unchecked, with dirty hands or at a dirty place nothing is washed, and raw food is not tasted."""
    checked = ("ingredients_checked", "ingredients_safe")
    clean: list[tuple[str, ...]] = [("workspace-clean",), ("robot-hands-clean", "robot1")]
    risk = ("cross-contamination-risk",)
    start = task.initial_state.with_facts(remove=[risk])
    wash = "(wash_ingredients robot1)"
    assert wash in task.applicable(at(start, "prep_station", *preparing("salad", *checked), *clean))
    assert wash not in task.applicable(at(start, "prep_station", *preparing("salad"), *clean))
    assert wash not in task.applicable(at(start, "prep_station", *preparing("salad", *checked), *clean, risk))
    for fact in clean:
        assert wash not in task.applicable(at(start, "prep_station", *preparing("salad", *checked), fact))
    raw = preparing("hot_meal", *checked, "ingredients_washed")
    chopped = task.apply(at(start, "prep_station", *raw, *clean), "(chop_ingredients robot1 hot_meal)")
    assert chopped.holds(risk)
    assert not chopped.holds(("workspace-clean",))
    cooked = task.apply(at(chopped, "stove"), "(cook_meal robot1 hot_meal)")
    assert not cooked.holds(risk)
    taste = "(check_palatability robot1 hot_meal)"
    assert taste not in task.applicable(at(chopped, "quality_check"))
    assert taste not in task.applicable(at(cooked, "quality_check"))
    level_checked = task.apply(cooked, "(check_cooking_level robot1)")
    assert taste in task.applicable(at(level_checked, "quality_check"))


def test_collecting_soils_the_hands(task: PlanningTask) -> None:
    state = at(task.initial_state, "pantry", ("robot-hands-clean", "robot1"))
    state = task.apply(state.with_facts(remove=[("cross-contamination-risk",)]), "(choose_salad robot1)")
    after = task.apply(state, "(collect_ingredient robot1 pantry nuts)")
    assert after.holds(("cross-contamination-risk",))
    assert not after.holds(("robot-hands-clean", "robot1"))


def test_nothing_is_delivered_that_was_not_tasted_and_assembled(task: PlanningTask) -> None:
    there = at(task.initial_state, "patient_bed_left", *preparing("salad"), ("can_be_deliverable", "robot1"))
    deliver = "(deliver_on_bedside_table_left robot1 salad)"
    both = [("meal_palatable", "robot1"), ("meal_assembled", "robot1")]
    for known in ([], both[:1], both[1:]):
        assert deliver not in task.applicable(there.with_facts(add=known))
    served = task.apply(there.with_facts(add=both), deliver)
    assert task.is_goal(served)
    assert not [fact for fact in served.facts if fact[0] == "collected_ingredient"]


@pytest.mark.parametrize("dish", DISHES)
def test_choosing_a_dish_makes_its_ingredients_missing(task: PlanningTask, dish: str) -> None:
    """The domain's recipes are the kitchen's."""
    after = task.apply(task.initial_state, f"(choose_{dish} robot1)")
    assert {fact[2] for fact in after.facts if fact[0] == "missing_ingredient"} == set(DISHES[dish].ingredients)
    assert after.holds(("requires_cooking", dish)) == DISHES[dish].cooked
    other = next(each for each in DISHES if each != dish)
    again = task.apply(after, f"(choose_{other} robot1)")
    assert [fact for fact in again.facts if fact[0] == "meal_to_prepare"] == [("meal_to_prepare", "robot1", other)]
    assert {fact[2] for fact in again.facts if fact[0] == "missing_ingredient"} == set(DISHES[other].ingredients)


def test_a_dish_out_of_stock_is_changed_for_another_as_long_as_nothing_is_wasted(
    task: PlanningTask, planner: Planner
) -> None:
    no_bread = task.initial_state.with_facts(remove=[("ingredient_available", "bread", "pantry")])
    chosen = task.apply(no_bread, "(choose_sandwich robot1)")
    with_vegetables = [("collected_ingredient", "robot1", "vegetables")]
    state = at(chosen, "pantry", *with_vegetables).with_facts(remove=[("missing_ingredient", "robot1", "vegetables")])
    plan = planner.solve(state, weights=PROFILES["speed_oriented"])
    collected = [action for action in plan.actions if action.startswith("(collect")]
    assert names(plan.actions)[0] == "choose_salad"
    assert collected == ["(collect_ingredient robot1 pantry nuts)"]
    # Bread in the gripper cannot be put back: without vegetables there is no dish for it.
    kept = [("collected_ingredient", "robot1", "bread")]
    nothing_else = [("ingredient_available", "vegetables", "pantry")]
    stuck = at(chosen, "pantry", *kept).with_facts(remove=[*nothing_else, ("missing_ingredient", "robot1", "bread")])
    assert planner.solve(stuck).status == "unsolvable"


@pytest.mark.parametrize("place", ["prep_station", "quality_check", "patient_bed_left", "in_transit"])
def test_a_lost_ingredient_is_fetched_again_from_wherever_it_is_missed(
    task: PlanningTask, planner: Planner, place: str
) -> None:
    costs_of_legs_in_transit = {
        (name, "in_transit", fact[2]): 0.05
        for fact in task.initial_state.facts
        if fact[:2] == ("connected", "in_transit")
        for name in ("nav-time", "location-safety", "nav-charge", "nav-battery", "proximity-feature")
    }
    known = [("meal_to_prepare", "robot1", "salad"), ("collected_ingredient", "robot1", "nuts")]
    state = at(task.initial_state, place, *known, ("missing_ingredient", "robot1", "vegetables"))
    state = with_charge(state.with_fluents(costs_of_legs_in_transit), 0.8)
    plan = planner.solve(state)
    stops = [stop for stop in stops_of(task, plan.actions, state) if stop not in CHARGERS]
    assert plan.found
    assert stops[:3] == ["pantry", "prep_station", "quality_check"]


def test_a_closed_way_is_not_taken(task: PlanningTask, planner: Planner) -> None:
    closed = [fact for fact in task.initial_state.facts if fact[0] == "connected" and fact[2] == "patient_bed_left"]
    plan = planner.solve(task.initial_state.with_facts(remove=closed), weights=PROFILES["comfort_focused"])
    assert "approach_to_right_side" in names(plan.actions)
