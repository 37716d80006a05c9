"""The task planner: what it dispatches when all goes as planned, and with what each plan is made."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from pydrake.common.value import Value
from pydrake.systems.framework import LeafSystem

import mala_drake.planning.task_planner as mut
from mala_drake import clock
from mala_drake.errors import BadInput
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    LearnedCosts,
    Outcome,
    PlanMessage,
    Preferences,
    TaskReport,
)
from mala_drake.patient.profiles import PROFILES
from mala_drake.ward.features import FEATURE_SCALES
from mala_drake.ward.ward_map import Ward

from .planner_bench import HAVE, PlannerBench

SPEED = PROFILES["speed_oriented"]
CORRECT = (*HAVE, ("correct-medication",))


def test_drawn_ports_are_the_real_ports(
    task_planner: mut.TaskPlanner, assert_port_box: Callable[[LeafSystem], None]
) -> None:
    assert_port_box(task_planner)


def test_without_a_task_nothing_is_dispatched(bench: PlannerBench) -> None:
    bench.tick(3)
    assert bench.action == Action()
    assert bench.plan == PlanMessage()
    assert bench.task_report == TaskReport()


def test_a_new_task_is_planned_and_its_first_action_dispatched(bench: PlannerBench) -> None:
    action = bench.start()
    assert action == Action(
        1, ActionKind.MOVE, "go_to_pharmacy_north", ("robot1", "home"), place="pharmacy_north", previous_place="home"
    )
    assert bench.plan.status == "optimal"
    assert bench.plan.actions[0] == action.text
    assert len(bench.plan.actions) == 8
    assert bench.task_report == TaskReport(sequence=1, plan_cost=bench.plan.cost)


def test_an_action_stays_until_its_own_report(bench: PlannerBench) -> None:
    first = bench.start()
    bench.give("leg_report", ActionReport(first.sequence, Outcome.RUNNING))
    bench.tick(3)
    assert bench.action is first
    bench.give("leg_report", ActionReport(first.sequence - 1, Outcome.SUCCESS))
    bench.give("in_place_report", ActionReport(first.sequence, Outcome.SUCCESS))
    bench.tick(3)
    assert bench.action is first


def test_a_finished_leg_is_followed_by_the_next_action(bench: PlannerBench) -> None:
    bench.start()
    bench.see("pharmacy_north", charge=0.81)
    action = bench.report()
    assert (action.sequence, action.kind) == (2, ActionKind.IN_PLACE)
    assert action.text == "(collect_med_antibiotic robot1 pharmacy_north)"
    assert (action.place, action.previous_place) == ("pharmacy_north", "pharmacy_north")
    assert bench.plan.sequence == 2
    assert bench.task_report.replans == 1
    assert bench.task_report.mismatches == 0
    assert bench.task_report.actions == ("(go_to_pharmacy_north robot1 home)",)


def test_a_whole_round_ends_with_success(bench: PlannerBench) -> None:
    bench.start()
    supplement = (("has-supplement",), ("supplement-is", "supp_vitamin_d"))
    both = (*CORRECT, *supplement, ("correct-supplement",))
    for place, own, charge in (
        ("pharmacy_north", (), 0.81),
        ("pharmacy_north", HAVE, 0.76),
        ("pharmacy_north", CORRECT, 0.74),
        ("supply_A", CORRECT, 0.61),
        ("supply_A", (*CORRECT, *supplement), 0.56),
        ("supply_A", both, 0.54),
        ("patient_bed_left", both, 0.46),
        ("patient_bed_left", (("delivered",),), 0.44),
    ):
        bench.see(place, *own, charge=charge)
        bench.report()
    report = bench.task_report
    assert report.finished
    assert report.success
    assert report.failure == ""
    assert [text.strip("()").split()[0] for text in report.actions] == [
        "go_to_pharmacy_north",
        "collect_med_antibiotic",
        "check_medication_correct",
        "go_to_supply_a",
        "collect_supp_vitamin_d",
        "check_supplement_correct",
        "approach_left_to_bed",
        "deliver_on_bedside_table_left",
    ]
    assert (report.replans, report.mismatches) == (8, 0)
    # The prediction at dispatch is that of the first plan, as nothing unexpected happened: cost = w' f + w0 f0 + steps.
    weighted = sum(w * f for w, f in zip(SPEED, report.predicted_features, strict=True))
    assert report.plan_cost == pytest.approx(weighted + SPEED[0] * report.predicted_features[0] + 0.08, abs=1e-9)
    # It is over: nothing more happens.
    last = bench.action
    bench.tick(3)
    assert bench.action is last
    assert bench.task_report is report


def test_each_plan_is_made_with_the_weights_of_its_moment(bench: PlannerBench) -> None:
    bench.start_at_the_pharmacy()
    assert "(approach_left_to_bed robot1 supply_a)" in bench.plan.actions
    bench.give("preferences", Preferences(planning=PROFILES["presentation_focused"]))
    bench.see("pharmacy_north", *HAVE, charge=0.76)
    bench.report()
    assert "(approach_right_to_bed robot1 supply_a)" in bench.plan.actions


def test_each_plan_is_made_with_the_costs_learned_by_then(bench: PlannerBench) -> None:
    bench.start_at_the_pharmacy()
    assert "(approach_left_to_bed robot1 supply_a)" in bench.plan.actions
    dear = (("approach-feature", "patient_bed_left"), 30.0)
    bench.planner.GetInputPort("learned_costs").FixValue(bench.context, Value(LearnedCosts((dear,), updates=1)))
    bench.see("pharmacy_north", *HAVE, charge=0.76)
    bench.report()
    assert "(approach_right_to_bed robot1 supply_a)" in bench.plan.actions


def test_the_features_predicted_at_dispatch_are_those_of_the_learned_costs(bench: PlannerBench) -> None:
    slow = (("nav-time", "home", "pharmacy_north"), 24.0)
    bench.planner.GetInputPort("learned_costs").FixValue(bench.context, Value(LearnedCosts((slow,), updates=1)))
    bench.start_at_the_pharmacy()
    assert bench.task_report.predicted_features[0] == pytest.approx(24.0 / FEATURE_SCALES["medication"].time, rel=1e-4)


def test_what_can_be_learned_is_predicted_for_all_its_tasks(task_planner: mut.TaskPlanner) -> None:
    names = {name[0] for name in task_planner.predictions}
    assert {"nav-time", "nav-charge", "nav-battery", "check-time", "cook-time", "approach-feature"} <= names
    assert "nearest-charger-battery" not in names
    assert "w0" not in names


def test_each_plan_starts_from_the_observed_charge(bench: PlannerBench) -> None:
    bench.start_at_the_pharmacy()
    bench.see("pharmacy_north", *HAVE, charge=0.35)  # Predicted was 0.75.
    bench.report()
    assert any(text.startswith("(recharge") for text in bench.plan.actions)


def test_a_goal_already_reached_needs_no_action(bench: PlannerBench) -> None:
    bench.see("patient_bed_left", ("delivered",))
    bench.start()
    assert bench.task_report.success
    assert bench.plan.status == "optimal"
    assert bench.action == Action()


def test_a_newer_task_replaces_the_current_one_and_sequences_go_on(bench: PlannerBench) -> None:
    first = bench.start()
    plan = bench.plan
    bench.see("", charge=0.9, pose=(0.6, 5.0, 1.4))
    second = bench.start(sequence=2)
    assert second.sequence == first.sequence + 1
    assert second.text == "(go_to_pharmacy_north robot1 in_transit)"
    assert bench.plan.sequence == plan.sequence + 1
    assert bench.task_report == TaskReport(sequence=2, plan_cost=bench.plan.cost)


def test_observations_are_newer_than_the_reports_they_are_read_with() -> None:
    """The planner's moment comes after the world's in the same tick, and before the executors' reports of the next."""
    moments = (clock.SENSE_OFFSET, clock.WORLD_OFFSET, clock.SCHEDULE_OFFSET, clock.PLAN_OFFSET)
    assert sorted(moments) == list(moments)
    assert min(clock.EXECUTE_OFFSET, clock.CONTROL_OFFSET) > clock.PLAN_OFFSET


def test_wall_times_are_kept_beside_the_state(task_planner: mut.TaskPlanner, bench: PlannerBench) -> None:
    before = len(task_planner.solve_seconds)
    bench.start()
    assert len(task_planner.solve_seconds) == before + 1
    assert task_planner.solve_seconds[-1] > 0


def test_the_same_inputs_give_the_same_actions_in_a_second_system(ward: Ward, bench: PlannerBench) -> None:
    other = PlannerBench(mut.TaskPlanner(ward), ward)
    for each in (bench, other):
        each.start_at_the_pharmacy()
    assert bench.plan == other.plan
    assert bench.action == other.action
    assert bench.planner.progress(bench.context) == other.planner.progress(other.context)


@pytest.mark.parametrize("limit", ["max_actions", "max_expansions"])
def test_limits_must_be_positive(ward: Ward, limit: str) -> None:
    with pytest.raises(BadInput, match=f"{limit}: 0; expected an integer >= 1"):
        mut.TaskPlanner(ward, **{limit: 0})
