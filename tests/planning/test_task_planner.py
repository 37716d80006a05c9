import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import LeafSystem

import mala_drake.planning.task_planner as mut
from mala_drake import clock
from mala_drake.errors import BadInput
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    Atom,
    LearnedCosts,
    Outcome,
    PlanMessage,
    Preferences,
    SymbolicState,
    Task,
    TaskReport,
)
from mala_drake.patient.profiles import PROFILES
from mala_drake.ward.features import FEATURE_SCALES
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import LoadWard, Ward

SPEED, SAFETY = PROFILES["speed_oriented"], PROFILES["safety_first"]
HAVE = (("has-medication",), ("medication-is", "med_antibiotic"))
CORRECT = (*HAVE, ("correct-medication",))


@pytest.fixture(scope="module")
def ward() -> Ward:
    return LoadWard()


@pytest.fixture(scope="module")
def planner(ward: Ward) -> mut.TaskPlanner:
    """One system for all tests: its contexts are independent of each other."""
    return mut.TaskPlanner(ward)


class Bench:
    """The planner alone, with everything around it played by the test."""

    def __init__(self, planner: mut.TaskPlanner, ward: Ward) -> None:
        self.ward = ward
        self.simulator = Simulator(planner)
        self.context = self.simulator.get_mutable_context()
        self.planner = planner
        self._fixed = {
            name: planner.GetInputPort(name).FixValue(self.context, Value(value))
            for name, value in (
                ("task", Task()),
                ("symbolic_state", SymbolicState()),
                ("leg_report", ActionReport()),
                ("in_place_report", ActionReport()),
                ("preferences", Preferences(planning=SPEED)),
            )
        }
        self.see("home")

    def give(self, name: str, value: Any) -> None:
        self._fixed[name].GetMutableData().set_value(value)

    def see(
        self,
        place: str,
        *own: tuple[str, ...],
        charge: float = 1.0,
        pose: tuple[float, float, float] | None = None,
        without: tuple[Atom, ...] = (),
    ) -> None:
        """Full shelves but for `without`; the robot at a place, or in transit at a pose, with some atoms of its own."""
        atoms: list[Atom] = [("available", item.kind, item.place) for item in all_items(self.ward)]
        atoms = [atom for atom in atoms if atom not in without]
        atoms += [(name, "robot1", *rest) for name, *rest in own]
        atoms += [("at", "robot1", place)] if place else []
        self.give("symbolic_state", SymbolicState(tuple(sorted(atoms)), place, charge))
        if pose is None:
            there = self.ward.place[place]
            pose = (there.x, there.y, there.yaw)
        self.planner.GetInputPort("robot_state").FixValue(self.context, [*pose, 0.0, 0.0, 0.0])

    def tick(self, count: int = 1) -> None:
        """Past the planner's moment in the next ticks."""
        for _ in range(count):
            self.simulator.AdvanceTo(self.context.get_time() + clock.TICK)

    def start(self, *, sequence: int = 1, name: str = "medication") -> Action:
        self.give("task", Task(sequence, name, sequence - 1))
        self.tick()
        return self.action

    def report(self, outcome: Outcome = Outcome.SUCCESS, *, detail: str = "") -> Action:
        """The current action has ended; its kind's executor says so."""
        port = "leg_report" if self.action.kind is ActionKind.MOVE else "in_place_report"
        self.give(port, ActionReport(self.action.sequence, outcome, detail=detail))
        self.tick()
        return self.action

    @property
    def action(self) -> Action:
        action: Action = self.planner.GetOutputPort("action").Eval(self.context)
        return action

    @property
    def plan(self) -> PlanMessage:
        plan: PlanMessage = self.planner.GetOutputPort("plan").Eval(self.context)
        return plan

    @property
    def task_report(self) -> TaskReport:
        report: TaskReport = self.planner.GetOutputPort("task_report").Eval(self.context)
        return report


@pytest.fixture
def bench(planner: mut.TaskPlanner, ward: Ward) -> Bench:
    return Bench(planner, ward)


def at_the_pharmacy(bench: Bench) -> Bench:
    """The robot stands at the northern pharmacy and is about to collect."""
    bench.start()
    bench.see("pharmacy_north", charge=0.8)
    bench.report()
    assert bench.action.name == "collect_med_antibiotic"
    return bench


def test_drawn_ports_are_the_real_ports(
    planner: mut.TaskPlanner, assert_port_box: Callable[[LeafSystem], None]
) -> None:
    assert_port_box(planner)


def test_without_a_task_nothing_is_dispatched(bench: Bench) -> None:
    bench.tick(3)
    assert bench.action == Action()
    assert bench.plan == PlanMessage()
    assert bench.task_report == TaskReport()


def test_a_new_task_is_planned_and_its_first_action_dispatched(bench: Bench) -> None:
    action = bench.start()
    assert action == Action(
        1, ActionKind.MOVE, "go_to_pharmacy_north", ("robot1", "home"), place="pharmacy_north", previous_place="home"
    )
    assert bench.plan.status == "optimal"
    assert bench.plan.actions[0] == action.text
    assert len(bench.plan.actions) == 8
    assert bench.task_report == TaskReport(sequence=1, plan_cost=bench.plan.cost)


def test_an_action_stays_until_its_own_report(bench: Bench) -> None:
    first = bench.start()
    bench.give("leg_report", ActionReport(first.sequence, Outcome.RUNNING))
    bench.tick(3)
    assert bench.action is first
    bench.give("leg_report", ActionReport(first.sequence - 1, Outcome.SUCCESS))
    bench.give("in_place_report", ActionReport(first.sequence, Outcome.SUCCESS))
    bench.tick(3)
    assert bench.action is first


def test_a_finished_leg_is_followed_by_the_next_action(bench: Bench) -> None:
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


def test_a_whole_round_ends_with_success(bench: Bench) -> None:
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


def test_each_plan_is_made_with_the_weights_of_its_moment(bench: Bench) -> None:
    at_the_pharmacy(bench)
    assert "(approach_left_to_bed robot1 supply_a)" in bench.plan.actions
    bench.give("preferences", Preferences(planning=PROFILES["presentation_focused"]))
    bench.see("pharmacy_north", *HAVE, charge=0.76)
    bench.report()
    assert "(approach_right_to_bed robot1 supply_a)" in bench.plan.actions


def test_each_plan_is_made_with_the_costs_learned_by_then(bench: Bench) -> None:
    at_the_pharmacy(bench)
    assert "(approach_left_to_bed robot1 supply_a)" in bench.plan.actions
    dear = (("approach-feature", "patient_bed_left"), 30.0)
    bench.planner.GetInputPort("learned_costs").FixValue(bench.context, Value(LearnedCosts((dear,), updates=1)))
    bench.see("pharmacy_north", *HAVE, charge=0.76)
    bench.report()
    assert "(approach_right_to_bed robot1 supply_a)" in bench.plan.actions


def test_the_features_predicted_at_dispatch_are_those_of_the_learned_costs(bench: Bench) -> None:
    slow = (("nav-time", "home", "pharmacy_north"), 24.0)
    bench.planner.GetInputPort("learned_costs").FixValue(bench.context, Value(LearnedCosts((slow,), updates=1)))
    at_the_pharmacy(bench)
    assert bench.task_report.predicted_features[0] == pytest.approx(24.0 / FEATURE_SCALES["medication"].time, rel=1e-4)


def test_what_can_be_learned_is_predicted_for_all_its_tasks(planner: mut.TaskPlanner) -> None:
    names = {name[0] for name in planner.predictions}
    assert {"nav-time", "nav-charge", "nav-battery", "check-time", "cook-time", "approach-feature"} <= names
    assert "nearest-charger-battery" not in names
    assert "w0" not in names


def test_each_plan_starts_from_the_observed_charge(bench: Bench) -> None:
    at_the_pharmacy(bench)
    bench.see("pharmacy_north", *HAVE, charge=0.35)  # Predicted was 0.75.
    bench.report()
    assert any(text.startswith("(recharge") for text in bench.plan.actions)


def test_a_wrong_item_found_by_the_check_runs_the_correction_branch(bench: Bench) -> None:
    at_the_pharmacy(bench)
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


def test_a_robot_pushed_away_replans_from_where_it_is(bench: Bench) -> None:
    bench.start()
    bench.see("", charge=0.9, pose=(2.0, 5.5, 0.3))
    action = bench.report()  # The leg says it has arrived; the grounding sees it elsewhere.
    assert bench.task_report.mismatches == 1
    assert action.text == "(go_to_pharmacy_north robot1 in_transit)"
    assert (action.place, action.previous_place) == ("pharmacy_north", "")
    bench.see("pharmacy_north", charge=0.8)
    assert bench.report().name == "collect_med_antibiotic"


def test_a_failed_leg_is_driven_again_from_where_it_ended(bench: Bench) -> None:
    bench.start()
    # Near enough for the fuzzy location, but it has not stopped at the standing pose.
    bench.see("pharmacy_north", charge=0.82, pose=(5.0, 16.6, 1.2))
    action = bench.report(Outcome.STEP_BUDGET)
    assert action.text == "(go_to_pharmacy_north robot1 in_transit)"
    assert action.kind is ActionKind.MOVE


def test_what_is_out_of_reach_is_approached_again(bench: Bench) -> None:
    at_the_pharmacy(bench)
    bench.see("pharmacy_north", charge=0.78, pose=(5.2, 17.5, 1.4))
    assert bench.report(Outcome.OUT_OF_REACH).text == "(go_to_pharmacy_north robot1 in_transit)"
    bench.see("pharmacy_north", charge=0.77)
    assert bench.report().name == "collect_med_antibiotic"


def test_a_blocked_way_is_closed_and_another_one_taken(bench: Bench) -> None:
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


def test_when_all_ways_are_blocked_the_task_fails_with_a_reason(bench: Bench) -> None:
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


def test_the_same_failure_three_times_ends_the_task(bench: Bench) -> None:
    at_the_pharmacy(bench)
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


def test_out_of_stock_here_is_fetched_elsewhere_and_nowhere_is_a_failure(bench: Bench) -> None:
    at_the_pharmacy(bench)
    north, south = (("available", "med_antibiotic", f"pharmacy_{side}") for side in ("north", "south"))
    bench.see("pharmacy_north", charge=0.8, without=(north,))
    assert bench.report(Outcome.OUT_OF_STOCK).place != "pharmacy_north"
    assert "(collect_med_antibiotic robot1 pharmacy_south)" in bench.plan.actions
    bench.see(bench.action.place, charge=0.6, without=(north, south))
    bench.report()
    assert bench.task_report.failure.startswith("no plan from")


def test_an_empty_battery_ends_the_task_at_once(bench: Bench) -> None:
    bench.start()
    bench.see("", charge=0.0, pose=(1.0, 5.0, 1.5))
    bench.report(Outcome.BATTERY_EMPTY)
    assert bench.task_report.failure == "battery empty during (go_to_pharmacy_north robot1 home)"


def test_too_little_charge_for_any_plan_is_reported_not_looped_on(bench: Bench) -> None:
    bench.see("home", charge=0.03)
    bench.start()
    assert bench.task_report.failure == "no plan from home at charge 0.03"
    assert bench.action == Action()


def test_too_many_actions_end_the_task(ward: Ward) -> None:
    bench = Bench(mut.TaskPlanner(ward, max_actions=3), ward)
    at_the_pharmacy(bench)
    bench.see("pharmacy_north", *HAVE, charge=0.76)
    bench.report()
    assert not bench.task_report.finished
    bench.see("pharmacy_north", charge=0.74)  # It fell.
    bench.report()
    assert bench.task_report.failure == "not done after 3 actions"
    assert len(bench.task_report.actions) == 3


def test_a_search_beyond_its_limit_is_a_failure_that_says_so(ward: Ward) -> None:
    bench = Bench(mut.TaskPlanner(ward, max_expansions=2), ward)
    bench.start()
    assert bench.plan.status == "limit"
    assert bench.task_report.failure == "the planner gave up after 2 expansions"


def test_a_goal_already_reached_needs_no_action(bench: Bench) -> None:
    bench.see("patient_bed_left", ("delivered",))
    bench.start()
    assert bench.task_report.success
    assert bench.plan.status == "optimal"
    assert bench.action == Action()


def test_an_unknown_task_fails(bench: Bench) -> None:
    bench.start(name="gardening")
    assert bench.task_report.failure == "unknown task 'gardening'"
    assert bench.task_report.sequence == 1


def test_a_lost_position_is_waited_for(bench: Bench) -> None:
    first = bench.start()
    bench.see("", charge=0.9, pose=(math.nan, 0.0, 0.0))
    bench.report(Outcome.INVALID_STATE)
    bench.tick(5)
    assert bench.action is first
    assert not bench.task_report.finished
    bench.see("", charge=0.9, pose=(0.6, 5.0, 1.4))
    bench.tick()
    assert bench.action.text == "(go_to_pharmacy_north robot1 in_transit)"


def test_a_position_lost_for_good_ends_the_task(bench: Bench) -> None:
    bench.start()
    bench.see("", charge=0.9, pose=(math.nan, math.nan, math.nan))
    bench.report(Outcome.INVALID_STATE)
    bench.tick(40)
    assert bench.task_report.failure == "the robot's position is not known"


def test_a_newer_task_replaces_the_current_one_and_sequences_go_on(bench: Bench) -> None:
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


def test_wall_times_are_kept_beside_the_state(planner: mut.TaskPlanner, bench: Bench) -> None:
    before = len(planner.solve_seconds)
    bench.start()
    assert len(planner.solve_seconds) == before + 1
    assert planner.solve_seconds[-1] > 0


def test_the_same_inputs_give_the_same_actions_in_a_second_system(ward: Ward, bench: Bench) -> None:
    other = Bench(mut.TaskPlanner(ward), ward)
    for each in (bench, other):
        at_the_pharmacy(each)
    assert bench.plan == other.plan
    assert bench.action == other.action
    assert bench.planner.progress(bench.context) == other.planner.progress(other.context)


@pytest.mark.parametrize("limit", ["max_actions", "max_expansions"])
def test_limits_must_be_positive(ward: Ward, limit: str) -> None:
    with pytest.raises(BadInput, match=f"{limit}: 0; expected an integer >= 1"):
        mut.TaskPlanner(ward, **{limit: 0})


@pytest.mark.parametrize("seed", range(4))
def test_whatever_happens_a_task_ends_with_a_verdict(bench: Bench, ward: Ward, seed: int) -> None:
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
