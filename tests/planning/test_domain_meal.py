"""The meal domain: what it offers, its rules, and that its data make the choices that the hospital case demands."""

import itertools
from collections import Counter
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from mala_drake.patient.profiles import PROFILES
from mala_drake.planning import Planner, PlanningTask, SymbolicState
from mala_drake.planning.care_tasks import CareTask
from mala_drake.planning.leg_costs import LegCosts
from mala_drake.resources import domains_folder
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.features import FEATURE_SCALES, IDEAL_HAND_OVER, approach_error
from mala_drake.ward.ward_map import LoadWard

MOVES = {"go_to_pantry", "go_to_fridge", "go_to_prep_station", "go_to_cooking_station", "go_to_quality_check"}
MOVES |= {"go_to_charge_main", "go_to_charge_backup", "approach_to_left_side", "approach_to_right_side"}
CARE = {"choose_sandwich", "choose_salad", "choose_hot_meal", "collect_ingredient", "check_ingredients"}
CARE |= {"sanitize_workspace", "wash_ingredients", "chop_ingredients", "cook_meal", "check_cooking_level"}
CARE |= {"check_palatability", "assemble", "recharge"}
CARE |= {"deliver_on_bedside_table_left", "deliver_on_bedside_table_right"}
CHARGERS = ("charge_main", "charge_backup")

# Seconds, with those until the planner knows, and charge of what is done at each place, by hand from the case's table.
AT_PREP_STATION = ((4.2, 0.01), (5.2, 0.02), (6.2, 0.02), (8.2, 0.03))
AT_STOVE = ((12.2, 0.5), (4.2, 0.01))


@pytest.fixture(scope="module")
def task() -> PlanningTask:
    folder = domains_folder()
    return PlanningTask.load(folder / "domain_meal.pddl", folder / "problem_meal.pddl")


@pytest.fixture(scope="module")
def planner(task: PlanningTask) -> Planner:
    return Planner(task)


@dataclass(frozen=True)
class Meal:
    """One way to serve a dish without mistakes: the places visited, the unscaled sums, and the scaled features."""

    dish: str
    stops: tuple[str, ...]
    length: float
    sums: NDArray[np.float64]
    features: NDArray[np.float64]
    actions: int
    penalty: float

    @property
    def side(self) -> str:
        return self.stops[-1].removeprefix("patient_bed_")

    def cost(self, weights: NDArray[np.float64]) -> float:
        """The metric, by hand: w' f, the penalty for low charges, the time once more, and 0.01 a step."""
        stage = weights @ self.features + weights[2] * self.penalty
        return float(stage + weights[0] * self.features[0] + 0.01 * self.actions)


@pytest.fixture(scope="module")
def meals() -> list[Meal]:
    """Every feasible way to a dish with at most two visits to chargers, to recharge or in passing, from the ward."""
    ward = LoadWard()
    costs = LegCosts(ward)
    names = [place.name for place in ward.places if place.category in ("home", "kitchen", "charger", "bedside")]
    legs = {(a, b): costs.between(a, b) for a, b in itertools.permutations(names, 2) if b != "home"}
    reserve = {a: min(0.0 if a == c else legs[a, c].charge for c in CHARGERS) for a in names if a != "home"}
    scales = FEATURE_SCALES["meal"].as_array()

    def work_at(stop: str, dish: str) -> tuple[tuple[float, float], ...]:
        kept = {"pantry": 1 if dish == "hot_meal" else 2, "fridge": 1}
        quality = ((4.2, 0.01), ({"salad": 13.6}.get(dish, 5.2), 0.02))
        done = {"prep_station": AT_PREP_STATION, "stove": AT_STOVE, "quality_check": quality}
        return done.get(stop, ((5.2, 0.02),) * kept.get(stop, 0))

    def simulate(dish: str, stops: tuple[str, ...], charging: tuple[bool, ...]) -> Meal | None:
        sums, charge, length, actions, penalty, here = np.zeros(5), 1.0, 0.0, 1, 0.0, "home"
        sums[0] = 0.8
        recharges = iter(charging)
        for stop in stops:
            leg = legs[here, stop]
            bedside = stop.startswith("patient")
            charge -= leg.charge
            if charge < reserve[stop] + (0.01 if bedside else 0.0):
                return None
            penalty += 0.2 * (charge < 0.25) + 0.5 * (charge < 0.15)
            sums += (leg.time, leg.risk, leg.charge, leg.discomfort, 0.0)
            length, actions, here = length + leg.length, actions + 1, stop
            if stop in CHARGERS and next(recharges):
                sums[0], charge, actions = sums[0] + 30.2, 1.0, actions + 1
            for seconds, used in work_at(stop, dish):
                sums[[0, 2]] += seconds, used
                charge, actions = charge - used, actions + 1
                if charge < reserve[stop]:
                    return None
            if bedside:
                place = ward.place[stop]
                error = approach_error((place.x, place.y, place.yaw), IDEAL_HAND_OVER)
                error += DISHES[dish].presentation_error
                sums += (10.2, 0.0, 0.01, costs.standing_discomfort(stop, 10.2), error)
                actions += 1
        return Meal(dish, stops, length, sums, sums / scales, actions, penalty)

    cold = ("pantry", "prep_station", "quality_check")
    hot = ("pantry", "fridge", "prep_station", "stove", "quality_check")
    found = []
    for dish, route in (("sandwich", cold), ("salad", cold), ("hot_meal", hot)):
        for side in ("left", "right"):
            places = (*route, f"patient_bed_{side}")
            for chargers in itertools.product((None, *CHARGERS), repeat=len(places)):
                visits = sum(charger is not None for charger in chargers)
                if visits > 2:
                    continue
                stops = tuple(s for pair in zip(chargers, places, strict=True) for s in pair if s is not None)
                for charging in itertools.product((False, True), repeat=visits):
                    found.append(simulate(dish, stops, charging))
    return [each for each in found if each is not None]


class Chooser:
    """The best meals at given weights, many at a time."""

    def __init__(self, meals: list[Meal]) -> None:
        self.meals = meals
        self.features = np.array([each.features for each in meals])
        self.rest = np.array([0.01 * each.actions for each in meals])
        self.penalties = np.array([each.penalty for each in meals])

    def costs(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        stage = self.features @ weights + weights[2] * self.penalties
        return stage + weights[0] * self.features[:, 0] + self.rest

    def best(self, weights: NDArray[np.float64]) -> Meal:
        return self.meals[int(np.argmin(self.costs(weights)))]


@pytest.fixture(scope="module")
def chooser(meals: list[Meal]) -> Chooser:
    return Chooser(meals)


@pytest.fixture(scope="module")
def chosen(chooser: Chooser) -> dict[str, Meal]:
    return {name: chooser.best(np.array(weights)) for name, weights in PROFILES.items()}


def stops_of(task: PlanningTask, actions: tuple[str, ...]) -> tuple[str, ...]:
    """The places that a plan visits."""
    state, stops = task.initial_state, []
    for action in actions:
        after = task.apply(state, action)
        (here,) = (fact[2] for fact in after.facts if fact[0] == "at")
        if not state.holds(("at", "robot1", here)):
            stops.append(here)
        state = after
    return tuple(stops)


def names(actions: tuple[str, ...]) -> list[str]:
    return [action.strip("()").split()[0] for action in actions]


def with_charge(state: SymbolicState, charge: float) -> SymbolicState:
    return state.with_fluents({("battery-soc", "robot1"): charge})


def at(state: SymbolicState, place: str, *facts: tuple[str, ...]) -> SymbolicState:
    here = [fact for fact in state.facts if fact[0] == "at"]
    return state.with_facts(add=[("at", "robot1", place), *facts], remove=here)


def preparing(dish: str, *done: str) -> list[tuple[str, ...]]:
    """The facts of a robot that holds the ingredients of a dish, with what has been done to them."""
    facts = [("meal_to_prepare", "robot1", dish)]
    facts += [("collected_ingredient", "robot1", kind) for kind in DISHES[dish].ingredients]
    return facts + [(each, "robot1") for each in done]


def test_the_domain_has_the_24_actions_of_the_paper(task: PlanningTask) -> None:
    assert {schema.name for schema in task.description.actions} == MOVES | CARE
    assert len(MOVES | CARE) == 24


def test_every_action_is_possible_in_some_state(task: PlanningTask) -> None:
    ground = {action.name.strip("()").split()[0] for action in task.grounding(task.initial_state).ground_task.actions}
    assert ground == MOVES | CARE


def test_it_speaks_of_what_the_paper_speaks_of(task: PlanningTask) -> None:
    predicates = (
        "meal_to_prepare ingredient_available connected collected_ingredient missing_ingredient ingredients_checked "
        "ingredients_safe workspace-clean robot-hands-clean cross-contamination-risk ingredients_washed "
        "ingredients_chopped requires_cooking meal_cooked cooking_level_checked meal_palatable meal_assembled "
        "can_be_deliverable delivered at"
    )
    assert set(task.description.predicates) == set(predicates.split())


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
    task: PlanningTask, planner: Planner, chooser: Chooser, chosen: dict[str, Meal], profile: str
) -> None:
    """At the five true weight vectors, against a list of meals that knows nothing of PDDL."""
    weights = np.array(PROFILES[profile])
    first = chosen[profile]
    plan = planner.solve(weights=PROFILES[profile])
    assert plan.cost is not None
    assert float(plan.cost) == pytest.approx(first.cost(weights), abs=1e-3)
    assert stops_of(task, plan.actions) == first.stops
    assert f"choose_{first.dish}" in names(plan.actions)
    costs = chooser.costs(weights)
    others = [
        cost
        for each, cost in zip(chooser.meals, costs, strict=True)
        if (each.dish, each.side) != (first.dish, first.side)
    ]
    assert min(others) - costs.min() > 0.008  # No near tie between choices that matter.


def test_the_optimal_plan_is_the_best_of_all_meals_at_random_weights(
    task: PlanningTask, planner: Planner, chooser: Chooser
) -> None:
    generator = np.random.default_rng(5)
    for weights in generator.dirichlet(np.full(5, 0.6), 40):
        plan = planner.solve(weights=weights.tolist())
        costs = chooser.costs(weights)
        assert plan.cost is not None
        assert float(plan.cost) == pytest.approx(costs.min(), abs=1e-3)
        near = [each.stops for each, cost in zip(chooser.meals, costs, strict=True) if cost < costs.min() + 1e-3]
        assert stops_of(task, plan.actions) in near


def test_the_profiles_choose_what_the_hospital_case_demands(meals: list[Meal], chosen: dict[str, Meal]) -> None:
    time, risk, charge, discomfort, error = range(5)
    speed, safety, energy = chosen["speed_oriented"], chosen["safety_first"], chosen["energy_conscious"]
    comfort, presentation = chosen["comfort_focused"], chosen["presentation_focused"]
    # Speed-oriented: the shortest and fastest of all, and the sandwich.
    assert speed.dish == "sandwich"
    assert speed.length == min(each.length for each in meals)
    assert speed.sums[time] == min(each.sums[time] for each in meals)
    # Safety-first: a longer way at less risk, to the right bedside; the left one is the riskier one.
    assert safety.side == "right"
    assert safety.length > speed.length
    assert safety.sums[risk] == min(each.sums[risk] for each in meals)
    assert safety.sums[risk] < 0.8 * speed.sums[risk]
    # Energy-conscious: no hot meal, and of its dish the way that takes the least.
    assert energy.dish != "hot_meal"
    assert energy.sums[charge] == min(each.sums[charge] for each in meals)
    # Presentation-focused: the best looking dish from the better side, although it costs time and energy.
    assert presentation.sums[error] == min(each.sums[error] for each in meals)
    assert (presentation.dish, presentation.side) == ("hot_meal", "right")
    assert presentation.sums[time] > 1.5 * speed.sums[time]
    assert presentation.sums[charge] > 1.5 * energy.sums[charge]
    # Comfort-focused: the gentler bedside.
    assert comfort.sums[discomfort] == pytest.approx(min(each.sums[discomfort] for each in meals))
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


def test_features_of_chosen_meals_are_spread_over_the_scale(chooser: Chooser, chosen: dict[str, Meal]) -> None:
    generator = np.random.default_rng(1)
    profiles = np.array([each.features for each in chosen.values()])
    sampled = np.array([chooser.best(weights).features for weights in generator.dirichlet(np.ones(5), 500)])
    for features in (profiles, sampled):
        assert features.min() > 0.2
        assert np.sum(np.median(features, axis=0) < 0.3) <= 1
    assert profiles.max() < 0.95
    assert sampled.max() < 1.05


@pytest.mark.parametrize("profile", PROFILES)
def test_no_profile_has_two_features_too_small_to_learn_from(chosen: dict[str, Meal], profile: str) -> None:
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
    legs = {
        (name, "in_transit", fact[2]): 1
        for fact in task.initial_state.facts
        if fact[:2] == ("connected", "in_transit")
        for name in ("nav-time", "location-safety", "nav-charge", "nav-battery", "proximity-feature")
    }
    fluents = {fluent: value / 20 for fluent, value in legs.items()}
    known = [("meal_to_prepare", "robot1", "salad"), ("collected_ingredient", "robot1", "nuts")]
    state = at(task.initial_state, place, *known, ("missing_ingredient", "robot1", "vegetables")).with_fluents(fluents)
    plan = planner.solve(with_charge(state, 0.8))
    stops = [fact for fact in stops_of_from(task, state, plan.actions) if fact not in CHARGERS]
    assert plan.found
    assert stops[:3] == ["pantry", "prep_station", "quality_check"]


def stops_of_from(task: PlanningTask, state: SymbolicState, actions: tuple[str, ...]) -> list[str]:
    stops = []
    for action in actions:
        after = task.apply(state, action)
        (here,) = (fact[2] for fact in after.facts if fact[0] == "at")
        if not state.holds(("at", "robot1", here)):
            stops.append(here)
        state = after
    return stops


def test_a_hot_meal_takes_more_than_one_charge(chosen: dict[str, Meal], planner: Planner) -> None:
    assert chosen["presentation_focused"].sums[2] > 1.0
    actions = names(planner.solve(weights=PROFILES["presentation_focused"]).actions)
    assert actions.count("recharge") >= 1
    assert "recharge" not in names(planner.solve(weights=PROFILES["comfort_focused"]).actions)


@pytest.mark.parametrize("charge", [1.0, 0.7, 0.5, 0.3])
def test_after_every_step_of_a_plan_a_charger_is_within_reach(
    task: PlanningTask, planner: Planner, charge: float
) -> None:
    state = with_charge(task.initial_state, charge)
    plan = planner.solve(state, weights=PROFILES["presentation_focused"])
    assert plan.found
    for action in plan.actions:
        state = task.apply(state, action)
        (here,) = (fact[2] for fact in state.facts if fact[0] == "at")
        needed = 0 if here == "home" else state.values[("nearest-charger-battery", here)]
        assert state.values[("battery-soc", "robot1")] >= needed


def test_without_charge_for_the_way_to_a_charger_there_is_no_plan(task: PlanningTask, planner: Planner) -> None:
    assert planner.solve(with_charge(task.initial_state, 0.04)).status == "unsolvable"


def test_arriving_low_costs_extra_below_a_quarter_and_more_below_15_percent(task: PlanningTask) -> None:
    move = "(go_to_charge_main robot1 home)"
    start = task.with_weights(task.initial_state, [0, 0, 1, 0, 0])
    used = start.values[("nav-battery", "home", "charge_main")]
    scaled = float(used * start.values[("feature-per-charge",)])

    def cost(arriving_at: float) -> float:
        after = task.apply(with_charge(start, arriving_at + float(used)), move)
        return float(after.values[("stage_cost",)]) - scaled

    assert cost(0.25) == pytest.approx(0.0)
    assert cost(0.249) == pytest.approx(0.2)
    assert cost(0.15) == pytest.approx(0.2)
    assert cost(0.149) == pytest.approx(0.7)


def test_a_closed_way_is_not_taken(task: PlanningTask, planner: Planner) -> None:
    closed = [fact for fact in task.initial_state.facts if fact[0] == "connected" and fact[2] == "patient_bed_left"]
    plan = planner.solve(task.initial_state.with_facts(remove=closed), weights=PROFILES["comfort_focused"])
    assert "approach_to_right_side" in names(plan.actions)


def test_predicted_features_of_a_plan_sum_up_to_its_cost() -> None:
    """Metric = w' f + w0 f_time + 0.01 n, with f from `features` and the cost from the planner."""
    care = CareTask("meal", LoadWard())
    weights = (0.3, 0.1, 0.25, 0.15, 0.2)
    plan = Planner(care.planning_task).solve(weights=weights)
    state, total = care.planning_task.initial_state, [0.0] * 5
    for action in plan.actions:
        total = [a + b for a, b in zip(total, care.features(state, action), strict=True)]
        state = care.planning_task.apply(state, action)
    by_hand = sum(w * f for w, f in zip(weights, total, strict=True)) + weights[0] * total[0]
    assert plan.cost is not None
    assert float(plan.cost) == pytest.approx(by_hand + 0.01 * len(plan.actions), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("profile", PROFILES)
def test_blind_uniform_cost_search_finds_no_better_plan(task: PlanningTask, planner: Planner, profile: str) -> None:
    blind = Planner(task, search="ucs").solve(weights=PROFILES[profile])
    assert blind.cost == planner.solve(weights=PROFILES[profile]).cost
