"""The medication domain: what it offers, and that its data make the choices that the hospital case demands."""

import itertools
from collections import Counter
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from mala_drake.patient.profiles import PROFILES
from mala_drake.planning import Planner, PlanningTask, SymbolicState
from mala_drake.planning.leg_costs import LegCosts
from mala_drake.resources import domains_folder
from mala_drake.ward.features import FEATURE_SCALES, IDEAL_HAND_OVER, approach_error
from mala_drake.ward.ward_map import LoadWard

MOVES = {
    f"go_to_{name}"
    for name in ("pharmacy_north", "pharmacy_south", "supply_a", "supply_b", "charge_main", "charge_backup")
} | {"approach_left_to_bed", "approach_right_to_bed"}
CARE = {f"collect_{kind}" for kind in ("med_antibiotic", "med_analgesic", "med_insulin")}
CARE |= {f"collect_{kind}" for kind in ("supp_vitamin_d", "supp_electrolyte", "supp_omega3")}
CARE |= {f"check_{what}_{verdict}" for what in ("medication", "supplement") for verdict in ("correct", "wrong")}
CARE |= {"put_down_medicine", "put_down_supplement", "recharge"}
CARE |= {"deliver_on_bedside_table_left", "deliver_on_bedside_table_right"}


@pytest.fixture(scope="module")
def task() -> PlanningTask:
    folder = domains_folder()
    return PlanningTask.load(folder / "domain_med.pddl", folder / "problem_med.pddl")


@pytest.fixture(scope="module")
def planner(task: PlanningTask) -> Planner:
    return Planner(task)


@dataclass(frozen=True)
class Round:
    """One way to do the round without mistakes: the places visited, the unscaled sums, and the scaled features."""

    stops: tuple[str, ...]
    length: float
    sums: NDArray[np.float64]
    features: NDArray[np.float64]
    actions: int

    def cost(self, weights: NDArray[np.float64]) -> float:
        """The metric, by hand: w' f, the time once more, and 0.01 a step."""
        return float(weights @ self.features + weights[0] * self.features[0] + 0.01 * self.actions)


@pytest.fixture(scope="module")
def rounds() -> list[Round]:
    """Every feasible round with at most one recharge before each stop after the first, straight from the ward."""
    ward = LoadWard()
    costs = LegCosts(ward)
    names = [place.name for place in ward.places if place.category != "kitchen"]
    legs = {(a, b): costs.between(a, b) for a, b in itertools.permutations(names, 2) if b != "home"}
    chargers = ("charge_main", "charge_backup")
    reserve = {a: min(0.0 if a == c else legs[a, c].charge for c in chargers) for a in names if a != "home"}
    scales = FEATURE_SCALES["medication"].as_array()

    def simulate(stops: tuple[str, ...]) -> Round | None:
        sums, charge, length, actions, here = np.zeros(5), 1.0, 0.0, 0, "home"
        for stop in stops:
            leg = legs[here, stop]
            bedside = stop.startswith("patient")
            charge -= leg.charge
            if charge < reserve[stop] + (0.02 if bedside else 0.0):
                return None
            sums += (leg.time, leg.risk, leg.charge, leg.discomfort, 0.0)
            length, actions, here = length + leg.length, actions + 1, stop
            if stop in chargers:
                sums[0], charge, actions = sums[0] + 30.2, 1.0, actions + 1
            elif bedside:
                place = ward.place[stop]
                error = approach_error((place.x, place.y, place.yaw), IDEAL_HAND_OVER)
                sums += (20.2, 0.0, 0.02, costs.standing_discomfort(stop, 20.2), error)
                actions += 1
            else:
                sums += (5.2 + 2.2, 0.0, 0.05 + 0.02, 0.0, 0.0)
                charge, actions = charge - 0.07, actions + 2
                if charge < reserve[stop]:
                    return None
        return Round(stops, length, sums, sums / scales, actions)

    found = []
    for pharmacy, supply, side in itertools.product(["north", "south"], "AB", ["left", "right"]):
        first, second = f"pharmacy_{pharmacy}", f"supply_{supply}"
        for one, two in ((first, second), (second, first)):
            for charging in itertools.product(((), *((c,) for c in chargers)), repeat=2):
                found.append(simulate((one, *charging[0], two, *charging[1], f"patient_bed_{side}")))
    return [each for each in found if each is not None]


def best(rounds: list[Round], weights: NDArray[np.float64]) -> list[Round]:
    return sorted(rounds, key=lambda each: each.cost(weights))


def stops_of(task: PlanningTask, actions: tuple[str, ...]) -> tuple[str, ...]:
    """The places that a plan visits, as the map spells them."""
    spelling = {place.name.lower(): place.name for place in LoadWard().places}
    state, stops = task.initial_state, []
    for action in actions:
        after = task.apply(state, action)
        (here,) = (fact[2] for fact in after.facts if fact[0] == "at")
        if not state.holds(("at", "robot1", here)):
            stops.append(spelling[here])
        state = after
    return tuple(stops)


def names(actions: tuple[str, ...]) -> list[str]:
    return [action.strip("()").split()[0] for action in actions]


def with_charge(state: SymbolicState, charge: float) -> SymbolicState:
    return state.with_fluents({("battery-soc", "robot1"): charge})


def test_the_domain_has_the_23_actions_of_the_paper(task: PlanningTask) -> None:
    assert {schema.name for schema in task.description.actions} == MOVES | CARE
    assert len(MOVES | CARE) == 23


def test_every_action_is_possible_in_some_state(task: PlanningTask) -> None:
    ground = {action.name.strip("()").split()[0] for action in task.grounding(task.initial_state).ground_task.actions}
    assert ground == MOVES | CARE


@pytest.mark.parametrize("profile", PROFILES)
def test_the_optimal_plan_is_the_best_of_all_rounds(
    task: PlanningTask, planner: Planner, rounds: list[Round], profile: str
) -> None:
    """At the five true weight vectors, against a list of rounds that knows nothing of PDDL."""
    weights = np.array(PROFILES[profile])
    plan = planner.solve(weights=PROFILES[profile])
    first, second = best(rounds, weights)[:2]
    assert plan.cost is not None
    assert float(plan.cost) == pytest.approx(first.cost(weights), abs=1e-3)
    assert stops_of(task, plan.actions) == first.stops
    assert second.cost(weights) - first.cost(weights) > 0.007  # No near tie between choices that matter.


def test_the_optimal_plan_is_the_best_of_all_rounds_at_random_weights(
    task: PlanningTask, planner: Planner, rounds: list[Round]
) -> None:
    generator = np.random.default_rng(5)
    for weights in generator.dirichlet(np.ones(5), 40):
        plan = planner.solve(weights=weights.tolist())
        ordered = best(rounds, weights)
        assert plan.cost is not None
        assert float(plan.cost) == pytest.approx(ordered[0].cost(weights), abs=1e-3)
        near = [each.stops for each in ordered if each.cost(weights) < ordered[0].cost(weights) + 1e-3]
        assert stops_of(task, plan.actions) in near


def test_the_profiles_choose_what_the_hospital_case_demands(rounds: list[Round]) -> None:
    chosen = {name: best(rounds, np.array(weights))[0] for name, weights in PROFILES.items()}
    speed, safety, energy = chosen["speed_oriented"], chosen["safety_first"], chosen["energy_conscious"]
    comfort, presentation = chosen["comfort_focused"], chosen["presentation_focused"]
    risk, charge, discomfort, error = 1, 2, 3, 4
    # Speed-oriented: the shortest and the fastest of all rounds.
    assert speed.length == min(each.length for each in rounds)
    assert speed.sums[0] == min(each.sums[0] for each in rounds)
    # Safety-first: longer, at less risk, and at the right bedside; the left one is the riskier one.
    assert safety.sums[risk] < 0.8 * speed.sums[risk]
    assert safety.length > speed.length
    assert safety.stops[-1] == "patient_bed_right"
    mirrored = next(each for each in rounds if each.stops == (*safety.stops[:-1], "patient_bed_left"))
    assert mirrored.sums[risk] > 1.2 * safety.sums[risk]
    # Energy-conscious: nearly the speed route, with the least charge of all.
    assert energy.length <= 1.1 * speed.length
    assert energy.sums[charge] == min(each.sums[charge] for each in rounds)
    # Presentation-focused: the better approach, although it costs time and energy.
    assert presentation.sums[error] == min(each.sums[error] for each in rounds)
    assert presentation.sums[0] > speed.sums[0]
    assert presentation.sums[charge] > energy.sums[charge]
    # Comfort-focused: the gentler bedside.
    other = next(each for each in rounds if each.stops == (*comfort.stops[:-1], "patient_bed_right"))
    assert comfort.stops[-1] == "patient_bed_left"
    assert comfort.sums[discomfort] < 0.8 * other.sums[discomfort]


def test_every_pharmacy_supply_room_and_bedside_is_the_best_choice_of_somebody(rounds: list[Round]) -> None:
    generator = np.random.default_rng(0)
    visits = Counter(
        stop for weights in generator.dirichlet(np.ones(5), 2000) for stop in best(rounds, weights)[0].stops
    )
    for place in ("pharmacy_north", "pharmacy_south", "supply_A", "supply_B", "patient_bed_left", "patient_bed_right"):
        assert visits[place] > 40, place


def test_features_of_chosen_rounds_are_spread_over_the_scale(rounds: list[Round]) -> None:
    generator = np.random.default_rng(1)
    chosen = [best(rounds, np.array(weights))[0].features for weights in PROFILES.values()]
    sampled = [best(rounds, weights)[0].features for weights in generator.dirichlet(np.ones(5), 500)]
    for features in (np.array(chosen), np.array(sampled)):
        assert features.min() > 0.2
        assert features.max() < 0.98
        assert np.sum(np.median(features, axis=0) < 0.3) <= 1
    assert np.array(chosen).max() < 0.9


def test_the_best_plan_never_collects_a_wrong_item_on_purpose(planner: Planner) -> None:
    generator = np.random.default_rng(2)
    for weights in generator.dirichlet(np.full(5, 0.4), 15):
        chosen = names(planner.solve(weights=weights.tolist()).actions)
        collected = [name for name in chosen if name.startswith("collect")]
        assert sorted(collected) == ["collect_med_antibiotic", "collect_supp_vitamin_d"]
        assert not [name for name in chosen if "wrong" in name or "put_down" in name]


@pytest.mark.parametrize(
    ("place", "what", "noun", "wrong"),
    [
        ("pharmacy_north", "medication", "medicine", "med_analgesic"),
        ("pharmacy_south", "medication", "medicine", "med_insulin"),
        ("supply_a", "supplement", "supplement", "supp_omega3"),
        ("supply_b", "supplement", "supplement", "supp_electrolyte"),
    ],
)
def test_a_wrong_item_in_hand_is_checked_put_down_and_collected_again(
    task: PlanningTask, planner: Planner, place: str, what: str, noun: str, wrong: str
) -> None:
    state = task.initial_state.with_facts(
        add=[("at", "robot1", place), (f"has-{what}", "robot1"), (f"{what}-is", "robot1", wrong)],
        remove=[("at", "robot1", "home")],
    )
    actions = names(planner.solve(with_charge(state, 0.7)).actions)
    branch = [name for name in actions if name.startswith(("check", "put_down", "collect"))][:4]
    right = {"medicine": "med_antibiotic", "supplement": "supp_vitamin_d"}[noun]
    assert branch == [f"check_{what}_wrong", f"put_down_{noun}", f"collect_{right}", f"check_{what}_correct"]


def test_nothing_unchecked_or_wrong_is_delivered(task: PlanningTask) -> None:
    carrying = task.initial_state.with_facts(
        add=[
            ("at", "robot1", "patient_bed_left"),
            ("has-medication", "robot1"),
            ("medication-is", "robot1", "med_antibiotic"),
            ("has-supplement", "robot1"),
            ("supplement-is", "robot1", "supp_vitamin_d"),
        ],
        remove=[("at", "robot1", "home")],
    )
    conditions = [("correct-medication", "robot1"), ("correct-supplement", "robot1")]
    deliver = "(deliver_on_bedside_table_left robot1)"
    for known in ([], conditions[:1], conditions[1:]):
        assert deliver not in task.applicable(carrying.with_facts(add=known))
    delivered = task.apply(carrying.with_facts(add=conditions), deliver)
    assert task.is_goal(delivered)
    # Nothing is left in the gripper.
    assert {fact[0] for fact in delivered.facts if fact[1:2] == ("robot1",)} == {"at", "delivered"}


def test_the_check_tells_requested_from_not_requested(task: PlanningTask) -> None:
    there = task.initial_state.with_facts(
        add=[("at", "robot1", "pharmacy_north"), ("has-medication", "robot1")], remove=[("at", "robot1", "home")]
    )
    for kind, verdict in (("med_antibiotic", "correct"), ("med_analgesic", "wrong"), ("med_insulin", "wrong")):
        labelled = there.with_facts(add=[("medication-is", "robot1", kind)])
        checks = [name for name in task.applicable(labelled) if name.startswith("(check_")]
        assert checks == [f"(check_medication_{verdict} robot1 pharmacy_north {kind})"]


def test_after_every_step_of_a_plan_a_charger_is_within_reach(task: PlanningTask, planner: Planner) -> None:
    for charge in (1.0, 0.8, 0.6, 0.4, 0.25):
        state = with_charge(task.initial_state, charge)
        plan = planner.solve(state, weights=PROFILES["presentation_focused"])
        assert plan.found
        for action in plan.actions:
            state = task.apply(state, action)
            (here,) = (fact[2] for fact in state.facts if fact[0] == "at")
            assert state.values[("battery-soc", "robot1")] >= state.values[("nearest-charger-battery", here)]


def test_a_low_charge_sends_the_robot_to_a_charger_first(task: PlanningTask, planner: Planner) -> None:
    actions = names(planner.solve(with_charge(task.initial_state, 0.3)).actions)
    assert "recharge" in actions
    assert "recharge" not in names(planner.solve(task.initial_state).actions)


def test_without_charge_for_the_way_to_a_charger_there_is_no_plan(task: PlanningTask, planner: Planner) -> None:
    assert planner.solve(with_charge(task.initial_state, 0.05)).status == "unsolvable"


def test_arriving_low_costs_extra_below_a_quarter_and_more_below_15_percent(task: PlanningTask) -> None:
    move = "(go_to_charge_main robot1 home)"
    start = task.with_weights(task.initial_state, [0, 0, 1, 0, 0])
    used = start.values[("nav-battery", "home", "charge_main")]

    def cost(arriving_at: float) -> float:
        after = task.apply(with_charge(start, arriving_at + float(used)), move)
        return float(after.values[("stage_cost",)] - used)

    assert cost(0.5) == pytest.approx(0.0)
    assert cost(0.25) == pytest.approx(0.0)
    assert cost(0.249) == pytest.approx(0.2)
    assert cost(0.15) == pytest.approx(0.2)
    assert cost(0.149) == pytest.approx(0.7)


def test_a_closed_way_is_not_taken(task: PlanningTask, planner: Planner) -> None:
    closed = [fact for fact in task.initial_state.facts if fact[0] == "open-way" and fact[2] == "pharmacy_north"]
    plan = planner.solve(task.initial_state.with_facts(remove=closed))
    assert "go_to_pharmacy_south" in names(plan.actions)


def test_what_is_out_of_stock_is_fetched_elsewhere(task: PlanningTask, planner: Planner) -> None:
    plan = planner.solve(task.initial_state.with_facts(remove=[("available", "supp_vitamin_d", "supply_a")]))
    assert "go_to_supply_b" in names(plan.actions)
    nowhere = [("available", "supp_vitamin_d", supply) for supply in ("supply_a", "supply_b")]
    assert planner.solve(task.initial_state.with_facts(remove=nowhere)).status == "unsolvable"


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["speed_oriented", "safety_first"])
def test_blind_uniform_cost_search_finds_no_better_plan(task: PlanningTask, planner: Planner, profile: str) -> None:
    blind = Planner(task, search="ucs").solve(weights=PROFILES[profile])
    assert blind.cost == planner.solve(weights=PROFILES[profile]).cost
