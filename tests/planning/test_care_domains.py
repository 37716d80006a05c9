"""What the two care domains have in common: the battery's rules, and plans that no blind search can better."""

import pytest

from mala_drake.patient.profiles import PROFILES
from mala_drake.planning import Planner, PlanningTask

from .plan_steps import care_domain, place_of, with_charge


@pytest.fixture(scope="module")
def tasks() -> dict[str, PlanningTask]:
    return {name: care_domain(name) for name in ("med", "meal")}


@pytest.fixture(scope="module")
def planners(tasks: dict[str, PlanningTask]) -> dict[str, Planner]:
    return {name: Planner(task) for name, task in tasks.items()}


@pytest.mark.parametrize(
    ("name", "charge"),
    [
        *(("med", charge) for charge in (1.0, 0.8, 0.6, 0.4, 0.25)),
        *(("meal", charge) for charge in (1.0, 0.7, 0.5, 0.3)),
    ],
)
def test_after_every_step_of_a_plan_a_charger_is_within_reach(
    tasks: dict[str, PlanningTask], planners: dict[str, Planner], name: str, charge: float
) -> None:
    task = tasks[name]
    state = with_charge(task.initial_state, charge)
    plan = planners[name].solve(state, weights=PROFILES["presentation_focused"])
    assert plan.found
    for action in plan.actions:
        state = task.apply(state, action)
        here = place_of(state)
        needed = 0 if here == "home" else state.values[("nearest-charger-battery", here)]
        assert state.values[("battery-soc", "robot1")] >= needed


@pytest.mark.parametrize(("name", "charge"), [("med", 0.05), ("meal", 0.04)])
def test_without_charge_for_the_way_to_a_charger_there_is_no_plan(
    tasks: dict[str, PlanningTask], planners: dict[str, Planner], name: str, charge: float
) -> None:
    assert planners[name].solve(with_charge(tasks[name].initial_state, charge)).status == "unsolvable"


@pytest.mark.parametrize("name", ["med", "meal"])
def test_arriving_low_costs_extra_below_a_quarter_and_more_below_15_percent(
    tasks: dict[str, PlanningTask], name: str
) -> None:
    task, move = tasks[name], "(go_to_charge_main robot1 home)"
    start = task.with_weights(task.initial_state, [0, 0, 1, 0, 0])
    used = start.values[("nav-battery", "home", "charge_main")]
    scaled = float(used * start.values[("feature-per-charge",)])

    def cost(arriving_at: float) -> float:
        after = task.apply(with_charge(start, arriving_at + float(used)), move)
        return float(after.values[("stage_cost",)]) - scaled

    assert cost(0.5) == pytest.approx(0.0)
    assert cost(0.25) == pytest.approx(0.0)
    assert cost(0.249) == pytest.approx(0.2)
    assert cost(0.15) == pytest.approx(0.2)
    assert cost(0.149) == pytest.approx(0.7)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "profile"),
    [("med", "speed_oriented"), ("med", "safety_first"), *(("meal", profile) for profile in PROFILES)],
)
def test_blind_uniform_cost_search_finds_no_better_plan(
    tasks: dict[str, PlanningTask], planners: dict[str, Planner], name: str, profile: str
) -> None:
    blind = Planner(tasks[name], search="ucs").solve(weights=PROFILES[profile])
    assert blind.cost == planners[name].solve(weights=PROFILES[profile]).cost
