import math

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.robot.feature_meter as mut
from mala_drake.clock import METER_OFFSET, TICK
from mala_drake.errors import BadInput
from mala_drake.messages import Action, ActionFeatures, ActionKind, EpisodeReport, Outcome, Task, TaskReport
from mala_drake.robot.plant_state import PLANT_STATE_SIZE, QW, QZ, X, Y
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.drive_path import make_drive_path
from mala_drake.ward.features import FEATURE_SCALES, IDEAL_HAND_OVER, FeatureRates, FeatureScales, approach_error
from mala_drake.ward.legs import leg_planner

_UNCUT = 1024.0  # More than any sum, and a power of two: features are the sums themselves, to the last bit.
UNCUT = dict.fromkeys(FEATURE_SCALES, FeatureScales(_UNCUT, _UNCUT, _UNCUT, _UNCUT, _UNCUT))


def sums_of(report):
    """The unscaled sums of a task that was measured with the scales `UNCUT`, by name."""
    names = ("duration", "risk", "charge_used", "discomfort", "approach_error")
    return {name: _UNCUT * feature for name, feature in zip(names, report.features, strict=True)}


def plant_state_at(x, y, yaw):
    state = np.zeros(PLANT_STATE_SIZE)
    state[[X, Y, QW, QZ]] = x, y, math.cos(yaw / 2), math.sin(yaw / 2)
    return state


class Stage:
    """A meter whose inputs are in the test's hands, at the beginning of task 1."""

    def __init__(self, ward, *, start=(0.0, 0.0, 0.0), charge=1.0, task="medication", scales=UNCUT, **options):
        self.meter = mut.FeatureMeter(ward, scales=scales, **options)
        self.simulator = Simulator(self.meter)
        self.context = self.simulator.get_mutable_context()
        self.task = self._fix("task", Value(Task(1, task)))
        self.report = self._fix("task_report", Value(TaskReport()))
        self.action = self._fix("action", Value(Action()))
        self.plant_state = self._fix("plant_state", plant_state_at(*start))
        self.charge = self._fix("charge", [charge])
        self.simulator.AdvanceTo(TICK / 2)

    def _fix(self, name, value):
        return self.meter.GetInputPort(name).FixValue(self.context, value)

    def output(self, name):
        return self.meter.GetOutputPort(name).Eval(self.context)

    def tick(self, *, pose=None, charge=None, action=None, arguments=()):
        if pose is not None:
            self.plant_state.GetMutableData().get_mutable_value().SetFromVector(plant_state_at(*pose))
        if charge is not None:
            self.charge.GetMutableData().get_mutable_value().SetFromVector([charge])
        if action is not None:
            self.action.GetMutableData().set_value(Action(1, ActionKind.IN_PLACE, action, arguments))
        self.simulator.AdvanceTo(self.context.get_time() + TICK)

    def finish(self, **report):
        self.report.GetMutableData().set_value(TaskReport(1, finished=True, **report))
        self.tick()
        return self.output("episode_report")

    def measured(self):
        """The unscaled sums of the finished task, by name."""
        return sums_of(self.finish(success=True))


def drive(stage, path):
    """Moves the robot along a drive path in its own time, sampled once a tick."""
    for time in np.arange(TICK, path.duration + TICK, TICK):
        length = np.interp(time, path.times, path.lengths)
        x, y = (np.interp(length, path.lengths, path.points[:, i]) for i in (0, 1))
        stage.tick(pose=(x, y, np.interp(length, path.lengths, path.headings)))


def test_drawn_ports_are_the_real_ports(ward, assert_port_box):
    assert_port_box(mut.FeatureMeter(ward))


def risk_on(ward, *, episode, **options):
    """The risk of one and the same drive, in an episode."""
    stage = Stage(ward, **options)
    stage.task.GetMutableData().set_value(Task(2, "medication", episode))
    stage.simulator.AdvanceTo(stage.context.get_time() + TICK)
    drive(stage, make_drive_path(leg_planner(ward).between("home", "pharmacy_north"), Congestion(ward)))
    stage.report.GetMutableData().set_value(TaskReport(2, finished=True, success=True))
    stage.tick()
    return sums_of(stage.output("episode_report"))


def test_on_a_busy_day_risk_alone_is_larger_and_nobody_knows_beforehand(ward):
    usual = risk_on(ward, episode=0)
    days = [risk_on(ward, episode=episode, risk_variation=0.15, seed=3) for episode in range(6)]
    factors = [day["risk"] / usual["risk"] for day in days]
    assert len(set(factors)) == 6
    assert all(0.85 <= factor <= 1.15 for factor in factors)
    assert max(factors) - min(factors) > 0.05
    for day in days:
        assert {**day, "risk": 0.0} == {**usual, "risk": 0.0}
    assert risk_on(ward, episode=2, risk_variation=0.15, seed=3) == days[2]
    assert risk_on(ward, episode=2, risk_variation=0.15, seed=4) != days[2]


@pytest.mark.parametrize("variation", [-0.1, 1.1, math.nan])
def test_a_variation_that_makes_risk_negative_is_refused(ward, variation):
    with pytest.raises(BadInput, match="risk_variation"):
        mut.FeatureMeter(ward, risk_variation=variation)


@pytest.mark.parametrize(
    ("start", "goal"),
    [("home", "pharmacy_north"), ("pharmacy_north", "supply_A"), ("supply_A", "patient_bed_left"), ("stove", "fridge")],
)
def test_measured_risk_and_discomfort_are_the_integrals_along_the_path(ward, start, goal):
    congestion, rates = Congestion(ward), FeatureRates(ward)
    path = make_drive_path(leg_planner(ward).between(start, goal), congestion)
    stage = Stage(ward, start=(*path.points[0], path.headings[0]))
    drive(stage, path)
    measured = stage.measured()
    assert measured["risk"] == pytest.approx(congestion.risk(path.points), rel=0.01)
    middles = 0.5 * (path.points[1:] + path.points[:-1])
    speeds = np.diff(path.lengths) / np.diff(path.times)
    discomfort = rates.discomfort_rate(middles, speeds) @ np.diff(path.times)
    assert measured["discomfort"] == pytest.approx(discomfort, rel=0.02, abs=0.05)
    assert measured["duration"] == pytest.approx(path.duration, abs=2 * TICK)


def test_standing_near_the_patient_is_felt_and_standing_elsewhere_is_not(ward):
    bedside = ward.place["patient_bed_left"]
    rate = FeatureRates(ward).discomfort_rate((bedside.x, bedside.y), 0.0)
    for place, expected in ((bedside, 2.0 * rate), (ward.place["home"], 0.0)):
        stage = Stage(ward, start=(place.x, place.y, 0.0))
        for _ in range(9):
            stage.tick()
        measured = stage.measured()
        assert measured["discomfort"] == pytest.approx(expected)
        assert measured["risk"] == 0.0
        assert measured["duration"] == pytest.approx(2.0)


def test_charge_given_back_is_no_negative_use(ward):
    stage = Stage(ward, charge=0.5)
    for charge in (0.4, 0.9, 1.0, 0.95):
        stage.tick(charge=charge)
    assert stage.measured()["charge_used"] == pytest.approx(0.15)
    report = stage.output("episode_report")
    assert (report.battery_start, report.battery_end) == pytest.approx((0.5, 0.95))


def test_the_approach_is_judged_where_things_are_handed_over(ward):
    stage = Stage(ward)
    stage.tick(pose=(0.2, 0.0, 0.0), action="check_medication_correct")
    stage.tick(pose=(0.3, 0.1, 0.4), action="deliver_on_bedside_table_left")
    stage.tick(pose=(0.5, 0.1, 0.5), action="recharge")
    assert stage.measured()["approach_error"] == pytest.approx(approach_error((0.3, 0.1, 0.4), IDEAL_HAND_OVER))


def test_without_a_hand_over_the_approach_is_the_worst(ward):
    stage = Stage(ward)
    stage.tick()
    assert stage.measured()["approach_error"] == 1.0


@pytest.mark.parametrize("dish", DISHES)
def test_the_looks_of_a_dish_count_with_the_pose_it_is_handed_over_from(ward, dish):
    stage = Stage(ward, task="meal")
    stage.tick(pose=(0.3, 0.1, 0.4), action="deliver_on_bedside_table_left", arguments=("robot1", dish))
    by_hand = approach_error((0.3, 0.1, 0.4), IDEAL_HAND_OVER) + DISHES[dish].presentation_error
    assert stage.measured()["approach_error"] == pytest.approx(by_hand)


def test_a_meal_that_is_not_served_looks_worse_than_any(ward):
    stage = Stage(ward, task="meal")
    stage.tick()
    assert stage.measured()["approach_error"] > max(dish.presentation_error for dish in DISHES.values()) + 0.7


def test_another_ideal_can_be_wanted(ward):
    stage = Stage(ward, ideal=(0.0, 0.0, 0.0))
    stage.tick(action="deliver_on_bedside_table_right")
    assert stage.measured()["approach_error"] == 0.0


def test_features_are_the_sums_by_their_scales_and_never_above_one(ward):
    scales = {"medication": FeatureScales(time=10.0, battery=0.01, approach=1.25)}
    stage = Stage(ward, scales=scales)
    stage.tick(charge=0.5)
    assert stage.output("features") == pytest.approx([TICK / 10.0, 0.0, 1.0, 0.0, 1.0 / 1.25])
    assert stage.finish(success=True).features == pytest.approx([2 * TICK / 10.0, 0.0, 1.0, 0.0, 1.0 / 1.25])


def test_tasks_are_measured_by_their_own_scales(ward):
    other = {"meal": FeatureScales(time=1.0)}
    stage = Stage(ward, scales=other)
    stage.tick()
    assert stage.output("features")[0] == pytest.approx(TICK / FEATURE_SCALES["medication"].time)


def test_the_report_carries_what_the_planner_said(ward):
    stage = Stage(ward)
    assert stage.output("episode_report") == EpisodeReport()
    report = stage.finish(
        success=False,
        failure="no way",
        actions=("(recharge robot1)",),
        plan_cost=1.5,
        predicted_features=(0.1, 0.2, 0.3, 0.4, 0.5),
        replans=3,
        mismatches=2,
    )
    assert (report.sequence, report.task, report.success, report.failure) == (1, "medication", False, "no way")
    assert (report.actions, report.plan_cost, report.replans, report.mismatches) == (("(recharge robot1)",), 1.5, 3, 2)
    assert report.predicted_features == (0.1, 0.2, 0.3, 0.4, 0.5)


def test_a_finished_task_is_measured_no_further(ward):
    stage = Stage(ward)
    report = stage.finish(success=True)
    for _ in range(5):
        stage.tick(pose=(1.0, 1.0, 0.0), charge=0.1)
    assert stage.output("episode_report") == report


def test_the_next_task_is_measured_from_its_own_beginning(ward):
    stage = Stage(ward, scales=FEATURE_SCALES)
    stage.tick(pose=(0.4, 0.0, 0.0), charge=0.7)
    stage.finish(success=True)
    stage.task.GetMutableData().set_value(Task(2, "medication", 1))
    stage.tick()
    assert stage.output("episode_report") == EpisodeReport()
    stage.tick()
    assert stage.output("features")[:4] == pytest.approx([TICK / FEATURE_SCALES["medication"].time, 0.0, 0.0, 0.0])


def test_the_report_is_there_in_the_tick_in_which_the_task_is_finished(ward):
    stage = Stage(ward)
    stage.report.GetMutableData().set_value(TaskReport(1, finished=True, success=True))
    stage.simulator.AdvanceTo(TICK + METER_OFFSET + 1e-4)
    assert stage.output("episode_report").sequence == 1


def test_an_old_report_does_not_close_a_new_task(ward):
    stage = Stage(ward)
    stage.task.GetMutableData().set_value(Task(2, "medication", 1))
    stage.tick()
    stage.finish(success=True)
    assert stage.output("episode_report") == EpisodeReport()


def begin_action(stage, sequence, kind=ActionKind.MOVE, name="go_to_supply_a", last=None, outcome=Outcome.SUCCESS):
    """The next action is dispatched, and the task report names the one before."""
    action = Action(sequence, kind, name, ("robot1",), place="patient_bed_left")
    stage.action.GetMutableData().set_value(action)
    if last is not None:
        stage.report.GetMutableData().set_value(TaskReport(1, last_action=last, last_outcome=outcome))
    return action


def test_what_an_action_took_is_told_when_it_has_ended(ward):
    stage = Stage(ward)
    assert stage.output("action_features") == ActionFeatures()
    first = begin_action(stage, 1)
    for charge in (0.99, 0.98, 0.97):
        stage.tick(charge=charge)
        assert stage.output("action_features") == ActionFeatures()
    begin_action(stage, 2, last=first)
    stage.tick(charge=0.96)
    told = stage.output("action_features")
    assert (told.action, told.outcome) == (first, Outcome.SUCCESS)
    # The first tick still belongs to nobody: the action was dispatched in it.
    assert (told.duration, told.charge_used) == pytest.approx((3 * TICK, 0.03))


def test_actions_add_up_to_the_episode(ward):
    stage = Stage(ward, start=(14.0, 10.0, 0.0))
    generator = np.random.default_rng(3)
    action, parts, position, charge = begin_action(stage, 1), [], np.array([14.0, 10.0]), 1.0
    stage.tick()
    for sequence in range(2, 7):
        for _ in range(generator.integers(1, 6)):
            position, charge = position + generator.uniform(0.0, 0.25, 2), charge - 0.01
            stage.tick(pose=(*position, 0.3), charge=charge)
        action = begin_action(stage, sequence, last=action)
        stage.tick()
        parts.append(stage.output("action_features"))
    report = TaskReport(1, finished=True, success=True, last_action=action, last_outcome=Outcome.SUCCESS)
    stage.report.GetMutableData().set_value(report)
    stage.tick()
    parts.append(stage.output("action_features"))
    assert [part.action.sequence for part in parts] == [1, 2, 3, 4, 5, 6]
    whole = sums_of(stage.output("episode_report"))
    whole["duration"] -= TICK  # Before the first action was seen.
    for name in ("duration", "risk", "charge_used", "discomfort"):
        assert sum(getattr(part, name) for part in parts) == pytest.approx(whole[name])


def test_a_hand_over_is_told_with_its_pose_and_without_the_looks_of_the_dish(ward):
    stage = Stage(ward)
    action = Action(1, ActionKind.IN_PLACE, "deliver_on_bedside_table_left", ("robot1", "sandwich"))
    stage.action.GetMutableData().set_value(action)
    stage.tick(pose=(0.3, 0.1, 0.4))
    report = TaskReport(1, finished=True, success=True, last_action=action, last_outcome=Outcome.SUCCESS)
    stage.report.GetMutableData().set_value(report)
    stage.tick()
    pose_error = approach_error((0.3, 0.1, 0.4), IDEAL_HAND_OVER)
    assert stage.output("action_features").approach_error == pytest.approx(pose_error)
    assert sums_of(stage.output("episode_report"))["approach_error"] > pose_error + 1.0


def test_what_the_report_does_not_name_as_the_last_action_is_not_told(ward):
    stage = Stage(ward)
    first = begin_action(stage, 1)
    stage.tick()
    second = begin_action(stage, 2, last=first)
    stage.tick()
    begin_action(stage, 3, last=second)
    assert stage.output("action_features") == ActionFeatures()  # The planner is ahead of the meter by an offset.
    stage.tick()
    assert stage.output("action_features").action == second


def test_before_any_task_nothing_is_measured(ward):
    stage = Stage(ward)
    stage.task.GetMutableData().set_value(Task())
    for _ in range(3):
        stage.tick()
    assert stage.output("features")[:4] == pytest.approx(np.zeros(4))
    assert stage.output("episode_report") == EpisodeReport()


def test_a_robot_that_is_carried_away_collects_no_risk_by_it(ward):
    stage = Stage(ward, start=(0.0, 0.0, 0.0))
    stage.tick(pose=(5.0, 18.0, 0.0))
    assert stage.measured()["risk"] == 0.0


def test_a_state_that_is_not_finite_adds_time_but_no_driving(ward):
    stage = Stage(ward)
    stage.tick(pose=(math.nan, 0.0, 0.0), charge=math.nan)
    stage.tick(pose=(0.2, 0.0, 0.0), charge=0.9)
    measured = stage.measured()
    assert all(math.isfinite(value) for value in measured.values())
    assert measured["risk"] == pytest.approx(Congestion(ward).risk([[0.0, 0.0], [0.2, 0.0]]))
    assert measured["charge_used"] == pytest.approx(0.1)
    assert measured["duration"] == pytest.approx(3 * TICK)
