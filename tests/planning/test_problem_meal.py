"""The data of the meal domain: they make the choices that the hospital case demands."""

from collections import Counter

import numpy as np
import pytest

from mala_drake.patient.profiles import PROFILES
from mala_drake.planning import Planner, PlanningTask
from mala_drake.planning.care_tasks import CareTask
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.ward_map import LoadWard

from .all_meals import all_meals
from .errands import CHARGE, CHARGERS, DISCOMFORT, ERROR, RISK, TIME, Chooser, Errand
from .plan_steps import names, stops_of

DOMAIN = "meal"


@pytest.fixture(scope="module")
def chooser() -> Chooser:
    return Chooser(all_meals())


@pytest.fixture(scope="module")
def chosen(chooser: Chooser) -> dict[str, Errand]:
    return chooser.of_profiles()


def test_the_graph_is_that_of_the_case(task: PlanningTask) -> None:
    kitchen = ("pantry", "fridge", "prep_station", "stove", "quality_check")
    beds = ("patient_bed_left", "patient_bed_right")
    ways = {("home", "pantry"), ("home", "fridge"), ("pantry", "fridge"), ("pantry", "prep_station")}
    ways |= {("fridge", "prep_station"), ("prep_station", "quality_check"), ("prep_station", "stove")}
    ways |= {("stove", "quality_check"), *(("quality_check", bed) for bed in beds)}
    ways |= {(charger, place) for charger in CHARGERS for place in (*kitchen, *beds)}
    ways |= {(p, charger) for charger in CHARGERS for p in ("home", *kitchen, *beds, *CHARGERS) if p != charger}
    ways |= {("in_transit", place) for place in (*kitchen, *beds, *CHARGERS)}
    assert {fact[1:] for fact in task.initial_state.facts if fact[0] == "connected"} == ways


@pytest.mark.parametrize("profile", PROFILES)
def test_the_optimal_plan_is_the_best_of_all_meals(
    task: PlanningTask, planner: Planner, chooser: Chooser, chosen: dict[str, Errand], profile: str
) -> None:
    """At the five true weight vectors, against a list of meals that knows nothing of PDDL."""
    weights = np.array(PROFILES[profile])
    first = chosen[profile]
    plan = planner.solve(weights=PROFILES[profile])
    assert plan.cost is not None
    assert float(plan.cost) == pytest.approx(chooser.costs(weights).min(), abs=1e-3)
    assert stops_of(task, plan.actions) == first.stops
    assert f"choose_{first.dish}" in names(plan.actions)
    near = chooser.nearly_best(weights, 0.008)
    # No near tie between choices that matter.
    assert {(each.dish, each.side) for each in near} == {(first.dish, first.side)}


def test_the_optimal_plan_is_the_best_of_all_meals_at_random_weights(
    task: PlanningTask, planner: Planner, chooser: Chooser
) -> None:
    generator = np.random.default_rng(5)
    for weights in generator.dirichlet(np.full(5, 0.6), 40):
        plan = planner.solve(weights=weights.tolist())
        assert plan.cost is not None
        assert float(plan.cost) == pytest.approx(chooser.costs(weights).min(), abs=1e-3)
        assert stops_of(task, plan.actions) in [each.stops for each in chooser.nearly_best(weights, 1e-3)]


def test_the_profiles_choose_what_the_hospital_case_demands(chooser: Chooser, chosen: dict[str, Errand]) -> None:
    meals = chooser.errands
    speed, safety, energy = chosen["speed_oriented"], chosen["safety_first"], chosen["energy_conscious"]
    comfort, presentation = chosen["comfort_focused"], chosen["presentation_focused"]
    # Speed-oriented: the shortest and fastest of all, and the sandwich.
    assert speed.dish == "sandwich"
    assert speed.length == min(each.length for each in meals)
    assert speed.sums[TIME] == min(each.sums[TIME] for each in meals)
    # Safety-first: a longer way at less risk, to the right bedside; the left one is the riskier one.
    assert safety.side == "right"
    assert safety.length > speed.length
    assert safety.sums[RISK] == min(each.sums[RISK] for each in meals)
    assert safety.sums[RISK] < 0.8 * speed.sums[RISK]
    # Energy-conscious: no hot meal, and of its dish the way that takes the least.
    assert energy.dish != "hot_meal"
    assert energy.sums[CHARGE] == min(each.sums[CHARGE] for each in meals)
    # Presentation-focused: the best looking dish from the better side, although it costs time and energy.
    assert presentation.sums[ERROR] == min(each.sums[ERROR] for each in meals)
    assert (presentation.dish, presentation.side) == ("hot_meal", "right")
    assert presentation.sums[TIME] > 1.5 * speed.sums[TIME]
    assert presentation.sums[CHARGE] > 1.5 * energy.sums[CHARGE]
    # Comfort-focused: the gentler bedside.
    assert comfort.sums[DISCOMFORT] == pytest.approx(min(each.sums[DISCOMFORT] for each in meals))
    assert comfort.side == "left"


def test_the_energy_conscious_never_gets_a_hot_meal_whatever_is_learned_nearby(chooser: Chooser) -> None:
    generator = np.random.default_rng(3)
    near = generator.dirichlet(100 * np.array(PROFILES["energy_conscious"]), 300)
    assert all(chooser.best(weights).dish != "hot_meal" for weights in near)


def test_every_dish_and_bedside_is_the_best_choice_of_somebody(chooser: Chooser) -> None:
    generator = np.random.default_rng(0)
    best = [chooser.best(weights) for weights in generator.dirichlet(np.ones(5), 2000)]
    dishes, sides = Counter(each.dish for each in best), Counter(each.side for each in best)
    assert min(dishes[dish] for dish in DISHES) > 30, dishes
    assert min(sides["left"], sides["right"]) > 500, sides
    assert any("charge_main" in each.stops for each in best)


def test_features_of_chosen_meals_are_spread_over_the_scale(chooser: Chooser, chosen: dict[str, Errand]) -> None:
    generator = np.random.default_rng(1)
    profiles = np.array([each.features for each in chosen.values()])
    sampled = np.array([chooser.best(weights).features for weights in generator.dirichlet(np.ones(5), 500)])
    for features in (profiles, sampled):
        assert features.min() > 0.2
        assert np.sum(np.median(features, axis=0) < 0.3) <= 1
    assert profiles.max() < 0.95
    assert sampled.max() < 1.05


@pytest.mark.parametrize("profile", PROFILES)
def test_no_profile_has_two_features_too_small_to_learn_from(chosen: dict[str, Errand], profile: str) -> None:
    """Medication and meals in turn: a weight shows in its rating as much as its feature is large."""
    care = CareTask("medication", LoadWard())
    state, total = care.planning_task.initial_state, np.zeros(5)
    for action in Planner(care.planning_task).solve(weights=PROFILES[profile]).actions:
        total += care.features(state, action)
        state = care.planning_task.apply(state, action)
    pooled = np.array([total, chosen[profile].features])
    assert np.sum(np.median(pooled, axis=0) < 0.3) <= 1
    # What an efficient estimator knows of each weight after forty episodes (standard deviation of a rating 0.1).
    assert (0.1 / (4.0 * np.sqrt(20 * np.sum(pooled**2, axis=0)))).max() < 0.015


def test_a_hot_meal_takes_more_than_one_charge(chosen: dict[str, Errand], planner: Planner) -> None:
    assert chosen["presentation_focused"].sums[CHARGE] > 1.0
    actions = names(planner.solve(weights=PROFILES["presentation_focused"]).actions)
    assert actions.count("recharge") >= 1
    assert "recharge" not in names(planner.solve(weights=PROFILES["comfort_focused"]).actions)
