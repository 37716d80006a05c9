"""The data of the medication domain: they make the choices that the hospital case demands."""

from collections import Counter

import numpy as np
import pytest

from mala_drake.patient.profiles import PROFILES
from mala_drake.planning import Planner, PlanningTask

from .all_rounds import all_rounds
from .errands import CHARGE, DISCOMFORT, ERROR, RISK, TIME, Chooser, Errand
from .plan_steps import stops_of

DOMAIN = "med"


@pytest.fixture(scope="module")
def chooser() -> Chooser:
    return Chooser(all_rounds())


@pytest.fixture(scope="module")
def chosen(chooser: Chooser) -> dict[str, Errand]:
    return chooser.of_profiles()


@pytest.mark.parametrize("profile", PROFILES)
def test_the_optimal_plan_is_the_best_of_all_rounds(
    task: PlanningTask, planner: Planner, chooser: Chooser, chosen: dict[str, Errand], profile: str
) -> None:
    """At the five true weight vectors, against a list of rounds that knows nothing of PDDL."""
    weights = np.array(PROFILES[profile])
    plan = planner.solve(weights=PROFILES[profile])
    assert plan.cost is not None
    assert float(plan.cost) == pytest.approx(chooser.costs(weights).min(), abs=1e-3)
    assert stops_of(task, plan.actions) == chosen[profile].stops
    near = [each.stops for each in chooser.nearly_best(weights, 0.007)]
    assert near == [chosen[profile].stops]  # No near tie between choices that matter.


def test_the_optimal_plan_is_the_best_of_all_rounds_at_random_weights(
    task: PlanningTask, planner: Planner, chooser: Chooser
) -> None:
    generator = np.random.default_rng(5)
    for weights in generator.dirichlet(np.ones(5), 40):
        plan = planner.solve(weights=weights.tolist())
        assert plan.cost is not None
        assert float(plan.cost) == pytest.approx(chooser.costs(weights).min(), abs=1e-3)
        assert stops_of(task, plan.actions) in [each.stops for each in chooser.nearly_best(weights, 1e-3)]


def test_the_profiles_choose_what_the_hospital_case_demands(chooser: Chooser, chosen: dict[str, Errand]) -> None:
    rounds = chooser.errands
    speed, safety, energy = chosen["speed_oriented"], chosen["safety_first"], chosen["energy_conscious"]
    comfort, presentation = chosen["comfort_focused"], chosen["presentation_focused"]
    # Speed-oriented: the shortest and the fastest of all rounds.
    assert speed.length == min(each.length for each in rounds)
    assert speed.sums[TIME] == min(each.sums[TIME] for each in rounds)
    # Safety-first: longer, at less risk, and at the right bedside; the left one is the riskier one.
    assert safety.sums[RISK] < 0.8 * speed.sums[RISK]
    assert safety.length > speed.length
    assert safety.stops[-1] == "patient_bed_right"
    mirrored = next(each for each in rounds if each.stops == (*safety.stops[:-1], "patient_bed_left"))
    assert mirrored.sums[RISK] > 1.2 * safety.sums[RISK]
    # Energy-conscious: nearly the speed route, with the least charge of all.
    assert energy.length <= 1.1 * speed.length
    assert energy.sums[CHARGE] == min(each.sums[CHARGE] for each in rounds)
    # Presentation-focused: the better approach, although it costs time and energy.
    assert presentation.sums[ERROR] == min(each.sums[ERROR] for each in rounds)
    assert presentation.sums[TIME] > speed.sums[TIME]
    assert presentation.sums[CHARGE] > energy.sums[CHARGE]
    # Comfort-focused: the gentler bedside.
    other = next(each for each in rounds if each.stops == (*comfort.stops[:-1], "patient_bed_right"))
    assert comfort.stops[-1] == "patient_bed_left"
    assert comfort.sums[DISCOMFORT] < 0.8 * other.sums[DISCOMFORT]


def test_every_pharmacy_supply_room_and_bedside_is_the_best_choice_of_somebody(chooser: Chooser) -> None:
    generator = np.random.default_rng(0)
    visits = Counter(stop for weights in generator.dirichlet(np.ones(5), 2000) for stop in chooser.best(weights).stops)
    for place in ("pharmacy_north", "pharmacy_south", "supply_A", "supply_B", "patient_bed_left", "patient_bed_right"):
        assert visits[place] > 40, place


def test_features_of_chosen_rounds_are_spread_over_the_scale(chooser: Chooser, chosen: dict[str, Errand]) -> None:
    generator = np.random.default_rng(1)
    profiles = np.array([each.features for each in chosen.values()])
    sampled = np.array([chooser.best(weights).features for weights in generator.dirichlet(np.ones(5), 500)])
    for features in (profiles, sampled):
        assert features.min() > 0.2
        assert features.max() < 0.98
        assert np.sum(np.median(features, axis=0) < 0.3) <= 1
    assert profiles.max() < 0.9
