import math
import os
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction

import pytest

import mala_drake.planning.care_tasks as mut
from mala_drake.errors import BadInput
from mala_drake.messages import Action, ActionKind, Atom, SymbolicState
from mala_drake.planning import Planner
from mala_drake.planning.leg_costs import LegCalibration, LegCosts
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import Ward

CHARGE = ("battery-soc", "robot1")


@pytest.fixture(scope="module")
def care(ward: Ward) -> mut.CareTask:
    return mut.CareTask("medication", ward)


def observed(ward: Ward, place: str, *own: tuple[str, ...], charge: float = 1.0) -> SymbolicState:
    """What the grounding sees of a robot at a place with full shelves, in the map's spelling."""
    atoms: list[Atom] = [("available", item.kind, item.place) for item in all_items(ward)]
    atoms += [(name, "robot1", *rest) for name, *rest in own]
    atoms += [("at", "robot1", place)] if place else []
    return SymbolicState(tuple(sorted(atoms)), place, charge)


def pose_of(ward: Ward, place: str) -> tuple[float, float, float]:
    there = ward.place[place]
    return (there.x, there.y, there.yaw)


def test_the_robot_at_home_with_full_shelves_is_the_initial_state(ward: Ward, care: mut.CareTask) -> None:
    state = care.observed_state(observed(ward, "home"), (0.0, 0.0, 0.0), standing_at="home")
    assert state == care.planning_task.initial_state


def test_places_keep_the_spelling_of_the_map_outside_the_planner(ward: Ward, care: mut.CareTask) -> None:
    state = care.observed_state(observed(ward, "supply_A"), pose_of(ward, "supply_A"), standing_at="supply_A")
    assert state.holds(("at", "robot1", "supply_a"))
    assert care.place(state) == "supply_A"


def test_the_observed_charge_replaces_the_predicted_one(ward: Ward, care: mut.CareTask) -> None:
    state = care.observed_state(observed(ward, "home", charge=0.625), (0.0, 0.0, 0.0), standing_at="home")
    assert state.values[CHARGE] == Fraction(5, 8)


def test_atoms_that_the_domain_does_not_know_are_left_out(ward: Ward, care: mut.CareTask) -> None:
    seen = observed(ward, "home")
    strange: tuple[Atom, ...] = (
        ("battery-low", "robot1"),
        ("has-medication", "robot2"),
        ("has-medication", "robot1", "twice"),
        ("medication-is", "robot1", "med_unknown"),
        ("open-way", "home", "home"),
    )
    state = care.observed_state(replace(seen, atoms=(*seen.atoms, *strange)), (0.0, 0.0, 0.0), standing_at="home")
    assert state == care.planning_task.initial_state


def test_in_transit_legs_are_predicted_from_where_the_robot_is(ward: Ward, care: mut.CareTask) -> None:
    pose = (8.0, -10.5, 0.3)
    state = care.observed_state(observed(ward, ""), pose, standing_at="")
    assert state.holds(("at", "robot1", "in_transit"))
    assert care.place(state) == ""
    leg = LegCosts(ward).from_pose(pose, "supply_B")
    assert leg is not None
    assert float(state.values[("nav-time", "in_transit", "supply_b")]) == pytest.approx(leg.time, abs=0.006)
    assert float(state.values[("nav-battery", "in_transit", "supply_b")]) == pytest.approx(leg.charge, abs=6e-5)
    plan = Planner(care.planning_task).solve(state)
    assert plan.found
    assert plan.steps()[0][1:] == ("robot1", "in_transit")


def test_near_a_place_but_not_at_its_standing_pose_is_in_transit(ward: Ward, care: mut.CareTask) -> None:
    near = (5.0, 17.0, 1.0)
    state = care.observed_state(observed(ward, "pharmacy_north"), near, standing_at="")
    assert state.holds(("at", "robot1", "in_transit"))
    assert 0 < state.values[("nav-time", "in_transit", "pharmacy_north")] < 10


def test_a_pose_that_is_not_finite_cannot_be_planned_from(ward: Ward, care: mut.CareTask) -> None:
    with pytest.raises(ValueError, match="not finite"):
        care.observed_state(observed(ward, ""), (math.nan, 0.0, 0.0), standing_at="")


def test_typical_states_cover_every_later_state_with_one_grounding_each(ward: Ward, care: mut.CareTask) -> None:
    task = care.planning_task
    at_place, in_transit = (task.grounding(state) for state in care.typical_states())
    carrying = ("has-medication",), ("medication-is", "med_insulin"), ("wrong-medication",)
    seen = observed(ward, "pharmacy_south", *carrying)
    pose = pose_of(ward, "pharmacy_south")
    assert task.grounding(care.observed_state(seen, pose, standing_at="pharmacy_south")) is at_place
    lost = replace(seen, place="")
    assert task.grounding(care.observed_state(lost, (1.0, 1.0, 0.0), standing_at="")) is in_transit


def test_movements_and_actions_in_place_become_messages(ward: Ward, care: mut.CareTask) -> None:
    task = care.planning_task
    home = task.initial_state
    move = "(go_to_supply_a robot1 home)"
    there = task.apply(home, move)
    assert care.action(move, home, there, sequence=7) == Action(
        7, ActionKind.MOVE, "go_to_supply_a", ("robot1", "home"), place="supply_A", previous_place="home"
    )
    collect = "(collect_supp_vitamin_d robot1 supply_a)"
    assert care.action(collect, there, task.apply(there, collect), sequence=8) == Action(
        8,
        ActionKind.IN_PLACE,
        "collect_supp_vitamin_d",
        ("robot1", "supply_a"),
        place="supply_A",
        previous_place="supply_A",
    )


def test_a_leg_that_begins_in_transit_has_no_previous_place(ward: Ward, care: mut.CareTask) -> None:
    state = care.observed_state(observed(ward, ""), (2.0, 2.0, 0.0), standing_at="")
    text = "(approach_left_to_bed robot1 in_transit)"
    action = care.action(text, state, care.planning_task.apply(state, text), sequence=1)
    assert (action.kind, action.place, action.previous_place) == (ActionKind.MOVE, "patient_bed_left", "")
    assert action.text == text


@pytest.mark.parametrize("name", ["medication", "meal"])
def test_predicted_features_of_a_plan_sum_up_to_its_cost(ward: Ward, name: str) -> None:
    """Metric = w' f + w0 f_time + 0.01 n, with f from `features` and the cost from the planner."""
    care = mut.CareTask(name, ward)
    weights = (0.3, 0.1, 0.25, 0.15, 0.2)
    plan = Planner(care.planning_task).solve(weights=weights)
    state, total = care.planning_task.initial_state, [0.0] * 5
    for action in plan.actions:
        total = [a + b for a, b in zip(total, care.features(state, action), strict=True)]
        state = care.planning_task.apply(state, action)
    assert plan.cost is not None
    by_hand = sum(w * f for w, f in zip(weights, total, strict=True)) + weights[0] * total[0]
    assert float(plan.cost) == pytest.approx(by_hand + 0.01 * len(plan.actions), abs=1e-9)


def test_the_battery_feature_is_charge_used_without_penalty_and_never_negative(care: mut.CareTask) -> None:
    task = care.planning_task
    low = task.initial_state.with_fluents({CHARGE: 0.2})
    move = "(go_to_charge_main robot1 home)"
    used = float(task.initial_state.values[("nav-battery", "home", "charge_main")])
    assert care.features(low, move)[2] == pytest.approx(used)
    at_charger = task.apply(low, move)
    recharge = care.features(at_charger, "(recharge robot1 charge_main)")
    assert recharge[1:] == (0.0, 0.0, 0.0, 0.0)
    assert recharge[0] > 0.1


def test_what_happened_as_expected_is_no_mismatch(ward: Ward, care: mut.CareTask) -> None:
    task = care.planning_task
    start = task.apply(task.initial_state, "(go_to_pharmacy_north robot1 home)")
    expected = task.apply(start, "(collect_med_antibiotic robot1 pharmacy_north)")
    seen = observed(ward, "pharmacy_north", ("has-medication",), ("medication-is", "med_antibiotic"))
    gone = tuple(atom for atom in seen.atoms if atom != ("available", "med_antibiotic", "pharmacy_north"))
    assert care.mismatch(expected, replace(seen, atoms=gone)) == ()


def test_a_mismatch_names_the_atoms_that_differ(ward: Ward, care: mut.CareTask) -> None:
    task = care.planning_task
    expected = task.apply(task.initial_state, "(go_to_pharmacy_north robot1 home)")
    assert care.mismatch(expected, observed(ward, "")) == (("at", "robot1", "pharmacy_north"),)
    assert care.mismatch(expected, observed(ward, "home")) == (
        ("at", "robot1", "home"),
        ("at", "robot1", "pharmacy_north"),
    )
    seen = observed(ward, "pharmacy_north", ("has-medication",))
    assert care.mismatch(expected, seen) == (("has-medication", "robot1"),)


def test_a_blocked_leg_closes_its_way_and_the_one_from_in_transit(care: mut.CareTask) -> None:
    leg = Action(1, ActionKind.MOVE, "go_to_supply_a", (), place="supply_A", previous_place="home")
    assert care.ways_closed_by(leg) == (("home", "supply_a"), ("in_transit", "supply_a"))


def test_a_blocked_leg_from_in_transit_closes_all_ways_to_its_target(care: mut.CareTask) -> None:
    closed = care.ways_closed_by(Action(1, ActionKind.MOVE, "go_to_supply_a", (), place="supply_A"))
    assert ("in_transit", "supply_a") in closed
    assert ("home", "supply_a") in closed
    assert ("pharmacy_south", "supply_a") in closed
    assert {goal for _, goal in closed} == {"supply_a"}
    assert len(closed) == 9


def test_closed_ways_are_closed_to_the_plan(ward: Ward, care: mut.CareTask) -> None:
    planner = Planner(care.planning_task)
    closed = (("home", "pharmacy_north"), ("supply_a", "pharmacy_north"))
    state = care.observed_state(observed(ward, "home"), (0.0, 0.0, 0.0), standing_at="home", closed=closed)
    actions = planner.solve(state).actions
    assert "(go_to_pharmacy_north robot1 home)" not in actions
    assert "(go_to_pharmacy_north robot1 supply_a)" not in actions


def test_another_ward_gets_its_own_numbers(ward: Ward, care: mut.CareTask) -> None:
    calm = replace(ward, zones=(), background_congestion=0.01)
    values = mut.CareTask("medication", calm).planning_task.initial_state.values
    shipped = care.planning_task.initial_state.values
    way = ("home", "pharmacy_north")
    assert values[("location-safety", *way)] < shipped[("location-safety", *way)]
    assert values[("nav-time", *way)] < shipped[("nav-time", *way)]


def test_other_leg_costs_give_other_numbers(ward: Ward, care: mut.CareTask) -> None:
    costs = LegCosts(ward, calibration=LegCalibration(charge_per_metre=LegCalibration().charge_per_metre + 0.001))
    values = mut.CareTask("medication", ward, costs=costs).planning_task.initial_state.values
    way = ("nav-battery", "home", "supply_b")
    difference = values[way] - care.planning_task.initial_state.values[way]
    leg = costs.between("home", "supply_B")
    assert leg is not None
    assert float(difference) == pytest.approx(0.001 * leg.length, abs=1e-4)


def test_a_ward_without_the_places_of_the_domain_is_refused(ward: Ward) -> None:
    smaller = replace(
        ward,
        name="annex",
        places=tuple(place for place in ward.places if place.name != "supply_B"),
        furniture=tuple(piece for piece in ward.furniture if piece.serves != "supply_B"),
    )
    with pytest.raises(BadInput, match="ward annex: has no place supply_b"):
        mut.CareTask("medication", smaller)


def test_plans_and_predictions_do_not_depend_on_the_hash_seed() -> None:
    script = """
from mala_drake.planning import Planner
from mala_drake.planning.care_tasks import CareTask
from mala_drake.messages import SymbolicState
from mala_drake.ward.ward_map import LoadWard
care = CareTask("medication", LoadWard())
atoms = tuple(atom for atom in care.planning_task.initial_state.facts if atom[0] == "available")
state = care.observed_state(SymbolicState(atoms, "", 0.8), (3.0, -2.0, 0.5), standing_at="")
plan = Planner(care.planning_task).solve(state, (0.2, 0.3, 0.1, 0.2, 0.2))
print(plan.actions, plan.cost, plan.expanded, care.features(state, plan.actions[0]))
"""
    printed = [
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    ]
    assert printed[0] == printed[1]
    assert "go_to_" in printed[0]


def test_an_unknown_task_is_refused(ward: Ward) -> None:
    with pytest.raises(BadInput, match="task: 'gardening'; expected one of medication"):
        mut.CareTask("gardening", ward)


def test_a_place_that_the_task_does_not_know_is_in_transit(ward: Ward) -> None:
    meal = mut.CareTask("meal", ward)
    stock = tuple(("ingredient_available", item.kind, item.place) for item in all_items(ward, ("meal",)))
    seen = SymbolicState((*stock, ("at", "robot1", "pharmacy_north")), "pharmacy_north", 1.0)
    state = meal.observed_state(seen, pose_of(ward, "pharmacy_north"), standing_at="pharmacy_north")
    assert state.holds(("at", "robot1", "in_transit"))
    assert Planner(meal.planning_task).solve(state).found


def test_a_meal_begins_as_its_problem_says(ward: Ward) -> None:
    meal = mut.CareTask("meal", ward)
    stock = {("ingredient_available", item.kind, item.place) for item in all_items(ward, ("meal",))}
    atoms = (*stock, ("cross-contamination-risk",), ("at", "robot1", "home"))
    state = meal.observed_state(SymbolicState(tuple(sorted(atoms)), "home", 1.0), (0.0, 0.0, 0.0), standing_at="home")
    assert state == meal.planning_task.initial_state


def test_what_became_of_the_food_and_the_workspace_is_compared_with_what_was_expected(ward: Ward) -> None:
    meal = mut.CareTask("meal", ward)
    expected = meal.planning_task.apply(meal.planning_task.initial_state, "(choose_salad robot1)")
    missing = tuple(("missing_ingredient", "robot1", kind) for kind in ("nuts", "vegetables"))
    known = (("meal_to_prepare", "robot1", "salad"), *missing, ("at", "robot1", "home"))
    seen = SymbolicState(tuple(sorted((*known, ("cross-contamination-risk",)))), "home", 1.0)
    assert meal.mismatch(expected, seen) == ()
    assert meal.mismatch(expected, replace(seen, atoms=known)) == (("cross-contamination-risk",),)
