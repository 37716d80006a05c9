import pytest

import mala_drake.ward.cost_parameters as mut
from mala_drake.messages import Action, ActionFeatures, ActionKind, Outcome
from mala_drake.planning import Planner
from mala_drake.planning.care_tasks import TASK_NAMES, CareTask
from mala_drake.ward.ward_map import LoadWard


def leg(*, start="home", goal="supply_A", outcome=Outcome.SUCCESS):
    action = Action(3, ActionKind.MOVE, "go_to_supply_a", ("robot1", start), place=goal, previous_place=start)
    return ActionFeatures(action, outcome, duration=18.0, risk=0.05, charge_used=0.15, discomfort=0.5)


def work(name, *arguments, place="patient_bed_left"):
    action = Action(3, ActionKind.IN_PLACE, name, arguments, place=place, previous_place=place)
    return ActionFeatures(action, Outcome.SUCCESS, duration=20.0, charge_used=0.02, discomfort=4.0, approach_error=0.6)


def test_a_leg_tells_of_its_four_costs_and_its_reserve_in_the_domains_spelling():
    assert mut.observed_parameters(leg()) == {
        ("nav-time", "home", "supply_a"): 18.0,
        ("location-safety", "home", "supply_a"): 0.05,
        ("nav-charge", "home", "supply_a"): 0.15,
        ("nav-battery", "home", "supply_a"): 0.15,
        ("proximity-feature", "home", "supply_a"): 0.5,
    }


@pytest.mark.parametrize(
    "features", [leg(outcome=Outcome.STEP_BUDGET), leg(start=""), ActionFeatures(), work("no_such_action")]
)
def test_failures_and_what_has_no_parameters_tell_nothing(features):
    assert mut.observed_parameters(features) == {}


def test_a_hand_over_tells_of_the_bedside():
    assert mut.observed_parameters(work("deliver_on_bedside_table_left", "robot1")) == {
        ("deliver-time",): 20.0,
        ("deliver-battery",): 0.02,
        ("approach-feature", "patient_bed_left"): 0.6,
        ("standing-proximity", "patient_bed_left"): 0.2,
    }


def test_assembling_is_told_apart_by_dish_and_a_recharge_uses_nothing():
    assert set(mut.observed_parameters(work("assemble", "robot1", "salad", place="quality_check"))) == {
        ("assemble-time", "salad"),
        ("assemble-battery", "salad"),
    }
    assert set(mut.observed_parameters(work("recharge", "robot1", "charge_main"))) == {("recharge-time",)}


@pytest.mark.parametrize("name", TASK_NAMES)
def test_every_action_of_a_plan_tells_of_parameters_that_its_domain_has(name):
    care = CareTask(name, LoadWard())
    state = care.planning_task.initial_state
    plan = Planner(care.planning_task).solve(state)
    assert plan.found
    for sequence, text in enumerate(plan.actions, start=1):
        after = care.planning_task.apply(state, text)
        action = care.action(text, state, after, sequence=sequence)
        observed = mut.observed_parameters(ActionFeatures(action, Outcome.SUCCESS, duration=1.0))
        assert observed
        assert set(observed) <= set(care.predictions)
        state = after
