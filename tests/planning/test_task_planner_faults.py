"""The task planner when something goes wrong: another way where there is one, and a reason where there is none."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mala_drake.planning.task_planner as mut
from mala_drake.messages import Action, ActionKind, Outcome, Preferences, SymbolicState
from mala_drake.ward.ward_map import Ward

from .planner_bench import HAVE, PlannerBench


def test_a_wrong_item_found_by_the_check_runs_the_correction_branch(bench: PlannerBench) -> None:
    bench.start_at_the_pharmacy()
    bench.see("pharmacy_north", *HAVE, charge=0.75)
    assert bench.report().name == "check_medication_correct"
    wrong = (("has-medication",), ("medication-is", "med_analgesic"))
    bench.see("pharmacy_north", *wrong, charge=0.73)
    assert bench.report().text == "(check_medication_wrong robot1 pharmacy_north med_analgesic)"
    assert bench.task_report.mismatches == 1
    bench.see("pharmacy_north", *wrong, ("wrong-medication",), charge=0.71)
    assert bench.report().name == "put_down_medicine"
    bench.see("pharmacy_north", charge=0.66)
    assert bench.report().name == "collect_med_antibiotic"
    assert bench.task_report.mismatches == 1


def test_a_robot_pushed_away_replans_from_where_it_is(bench: PlannerBench) -> None:
    bench.start()
    bench.see("", charge=0.9, pose=(2.0, 5.5, 0.3))
    action = bench.report()  # The leg says it has arrived; the grounding sees it elsewhere.
    assert bench.task_report.mismatches == 1
    assert action.text == "(go_to_pharmacy_north robot1 in_transit)"
    assert (action.place, action.previous_place) == ("pharmacy_north", "")
    bench.see("pharmacy_north", charge=0.8)
    assert bench.report().name == "collect_med_antibiotic"


def test_a_failed_leg_is_driven_again_from_where_it_ended(bench: PlannerBench) -> None:
    bench.start()
    # Near enough for the fuzzy location, but it has not stopped at the standing pose.
    bench.see("pharmacy_north", charge=0.82, pose=(5.0, 16.6, 1.2))
    action = bench.report(Outcome.STEP_BUDGET)
    assert action.text == "(go_to_pharmacy_north robot1 in_transit)"
    assert action.kind is ActionKind.MOVE


def test_what_is_out_of_reach_is_approached_again(bench: PlannerBench) -> None:
    bench.start_at_the_pharmacy()
    bench.see("pharmacy_north", charge=0.78, pose=(5.2, 17.5, 1.4))
    assert bench.report(Outcome.OUT_OF_REACH).text == "(go_to_pharmacy_north robot1 in_transit)"
    bench.see("pharmacy_north", charge=0.77)
    assert bench.report().name == "collect_med_antibiotic"


def test_a_blocked_way_is_closed_and_another_one_taken(bench: PlannerBench) -> None:
    bench.start()
    bench.see("", charge=0.95, pose=(0.5, 4.0, 1.4))
    action = bench.report(Outcome.BLOCKED)
    assert action.kind is ActionKind.MOVE
    assert action.place != "pharmacy_north"
    # The way is closed for this task only.
    state = bench.planner.progress(bench.context)
    assert ("home", "pharmacy_north") in state.closed
    bench.see("home")
    assert bench.start(sequence=2).place == "pharmacy_north"
    assert bench.planner.progress(bench.context).closed == ()


def test_when_all_ways_are_blocked_the_task_fails_with_a_reason(bench: PlannerBench) -> None:
    bench.start()
    for _ in range(20):
        if bench.task_report.finished:
            break
        bench.see("", charge=0.95, pose=(0.5, 2.0, 1.4))
        bench.report(Outcome.BLOCKED)
    report = bench.task_report
    assert report.finished
    assert not report.success
    assert report.failure == "no plan from in transit at charge 0.95"
    assert bench.plan.status == "unsolvable"


def test_the_same_failure_three_times_ends_the_task(bench: PlannerBench) -> None:
    bench.start_at_the_pharmacy()
    bench.see("pharmacy_north", charge=0.8)
    bench.report(Outcome.NOT_THERE, detail="the box fell")
    bench.report(Outcome.NOT_THERE, detail="the box fell")
    assert not bench.task_report.finished
    bench.report(Outcome.NOT_THERE, detail="the box fell")
    report = bench.task_report
    assert report.finished
    assert not report.success
    assert report.failure == "(collect_med_antibiotic robot1 pharmacy_north) failed 3 times: not_there (the box fell)"
    assert len(report.actions) == 4


def test_out_of_stock_here_is_fetched_elsewhere_and_nowhere_is_a_failure(bench: PlannerBench) -> None:
    bench.start_at_the_pharmacy()
    north, south = (("available", "med_antibiotic", f"pharmacy_{side}") for side in ("north", "south"))
    bench.see("pharmacy_north", charge=0.8, without=(north,))
    assert bench.report(Outcome.OUT_OF_STOCK).place != "pharmacy_north"
    assert "(collect_med_antibiotic robot1 pharmacy_south)" in bench.plan.actions
    bench.see(bench.action.place, charge=0.6, without=(north, south))
    bench.report()
    assert bench.task_report.failure.startswith("no plan from")


def test_an_empty_battery_ends_the_task_at_once(bench: PlannerBench) -> None:
    bench.start()
    bench.see("", charge=0.0, pose=(1.0, 5.0, 1.5))
    bench.report(Outcome.BATTERY_EMPTY)
    assert bench.task_report.failure == "battery empty during (go_to_pharmacy_north robot1 home)"


def test_too_little_charge_for_any_plan_is_reported_not_looped_on(bench: PlannerBench) -> None:
    bench.see("home", charge=0.03)
    bench.start()
    assert bench.task_report.failure == "no plan from home at charge 0.03"
    assert bench.action == Action()


def test_too_many_actions_end_the_task(ward: Ward) -> None:
    bench = PlannerBench(mut.TaskPlanner(ward, max_actions=3), ward)
    bench.start_at_the_pharmacy()
    bench.see("pharmacy_north", *HAVE, charge=0.76)
    bench.report()
    assert not bench.task_report.finished
    bench.see("pharmacy_north", charge=0.74)  # It fell.
    bench.report()
    assert bench.task_report.failure == "not done after 3 actions"
    assert len(bench.task_report.actions) == 3


def test_a_search_beyond_its_limit_is_a_failure_that_says_so(ward: Ward) -> None:
    bench = PlannerBench(mut.TaskPlanner(ward, max_expansions=2), ward)
    bench.start()
    assert bench.plan.status == "limit"
    assert bench.task_report.failure == "the planner gave up after 2 expansions"


def test_an_unknown_task_fails(bench: PlannerBench) -> None:
    bench.start(name="gardening")
    assert bench.task_report.failure == "unknown task 'gardening'"
    assert bench.task_report.sequence == 1


def test_a_lost_position_is_waited_for(bench: PlannerBench) -> None:
    first = bench.start()
    bench.see("", charge=0.9, pose=(math.nan, 0.0, 0.0))
    bench.report(Outcome.INVALID_STATE)
    bench.tick(5)
    assert bench.action is first
    assert not bench.task_report.finished
    bench.see("", charge=0.9, pose=(0.6, 5.0, 1.4))
    bench.tick()
    assert bench.action.text == "(go_to_pharmacy_north robot1 in_transit)"


def test_a_position_lost_for_good_ends_the_task(bench: PlannerBench) -> None:
    bench.start()
    bench.see("", charge=0.9, pose=(math.nan, math.nan, math.nan))
    bench.report(Outcome.INVALID_STATE)
    bench.tick(40)
    assert bench.task_report.failure == "the robot's position is not known"


@pytest.mark.parametrize("seed", range(4))
def test_whatever_happens_a_task_ends_with_a_verdict(bench: PlannerBench, ward: Ward, seed: int) -> None:
    """Actions that fail, go wrong or are undone at random: success exactly when the goal was observed."""
    generator = np.random.default_rng(seed)
    bad = [Outcome.STEP_BUDGET, Outcome.BLOCKED, Outcome.NOT_THERE, Outcome.OUT_OF_REACH, Outcome.SOLVER_FAILURE]
    bench.give("preferences", Preferences(planning=tuple(generator.dirichlet(np.ones(5)).tolist())))
    bench.start()
    believed = bench.planner.progress(bench.context)
    for _ in range(61):
        if bench.task_report.finished:
            break
        believed = bench.planner.progress(bench.context)
        assert believed.expected is not None
        assert believed.state is not None
        failing = generator.random() < 0.3
        reached = believed.state if failing else believed.expected
        own = [(fact[0], *fact[2:]) for fact in sorted(reached.facts) if fact[1:2] == ("robot1",) and fact[0] != "at"]
        if own and generator.random() < 0.1:
            own.pop()  # Something is lost on the way.
        charge = float(reached.values[("battery-soc", "robot1")])
        if failing and bench.action.kind is ActionKind.MOVE:
            bench.see("", *own, charge=charge, pose=(float(generator.uniform(0, 5)), 3.0, 0.0))
        else:
            bench.see(bench.action.place, *own, charge=charge)
        bench.report(bad[int(generator.integers(len(bad)))] if failing else Outcome.SUCCESS)
    report = bench.task_report
    assert report.finished
    assert report.success == (report.failure == "")
    observed: SymbolicState = bench.planner.GetInputPort("symbolic_state").Eval(bench.context)
    assert report.success == (("delivered", "robot1") in observed.atoms)
