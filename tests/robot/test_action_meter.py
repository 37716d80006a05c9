"""The action meter, with its inputs in the test's hands: values worked out by hand, at the right moment."""

from __future__ import annotations

import math

import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.robot.action_meter as mut
from mala_drake.clock import TICK
from mala_drake.messages import (
    Action,
    ActionEvaluation,
    ActionFeatures,
    ActionKind,
    ActionReport,
    Outcome,
    PlaceMismatch,
    Preferences,
    Task,
    TaskReport,
)
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.features import FeatureScales

SCALES = FeatureScales(time=100.0, safety=0.2, battery=1.0, proximity=10.0, approach=2.0)
WEIGHTS = (0.4, 0.1, 0.3, 0.2, 0.0)
LEG = Action(1, ActionKind.MOVE, "go_to_supply_a", ("robot1", "home"), place="supply_A")
WORK = Action(2, ActionKind.IN_PLACE, "collect_supp_omega3", ("robot1",), place="supply_A")


class Stage:
    """A meter in a simulation, told tick by tick what the layers say."""

    def __init__(self):
        scales = {"medication": SCALES, "meal": SCALES}
        self.system = mut.ActionMeter(bedsides=["patient_bed_left"], scales=scales, ideal=(2.0, 0.0, 0.0))
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        values = {
            "task": Task(1, "medication"),
            "task_report": TaskReport(),
            "action": Action(),
            "leg_report": ActionReport(),
            "in_place_report": ActionReport(),
            "place_mismatch": PlaceMismatch(),
            "preferences": Preferences(planning=WEIGHTS),
            "action_features": ActionFeatures(),
        }
        self._ports = {
            name: self.system.GetInputPort(name).FixValue(self.context, Value(value)) for name, value in values.items()
        }
        self._robot_state = self.system.GetInputPort("robot_state").FixValue(self.context, [0.0] * 6)

    def tick(self, *, pose=(0.0, 0.0, 0.0), **values) -> ActionEvaluation:
        self._robot_state.GetMutableData().get_mutable_value().SetFromVector([*pose, 0.0, 0.0, 0.0])
        for name, value in values.items():
            self._ports[name].GetMutableData().set_value(value)
        self.simulator.AdvanceTo(self.context.get_time() + TICK)
        return self.system.GetOutputPort("action_evaluation").Eval(self.context)


def ended(action, *, outcome=Outcome.SUCCESS, differing=(), predicted=(0.2, 0.0, 0.1, 0.0, 0.0), **measured):
    """What the planner and the feature meter say in the tick after an action has ended."""
    return {
        "task_report": TaskReport(
            1, last_action=action, last_outcome=outcome, last_predicted=predicted, last_differing=differing
        ),
        "action_features": ActionFeatures(action, outcome, **measured),
    }


@pytest.fixture
def stage():
    return Stage()


def drive(stage, *, error=0.25, cost=340.0):
    """A leg that has just ended, before the planner knows."""
    stage.tick(action=LEG, place_mismatch=PlaceMismatch("supply_A", 1.0), leg_report=ActionReport(1))
    return stage.tick(
        place_mismatch=PlaceMismatch("supply_A", error),
        leg_report=ActionReport(1, Outcome.SUCCESS, closed_loop_cost=cost),
    )


def test_drawn_ports_are_the_real_ports(stage, assert_port_box):
    assert_port_box(stage.system)


def test_nothing_is_said_before_the_first_action_has_ended(stage):
    assert stage.tick() == ActionEvaluation()
    assert drive(stage) == ActionEvaluation()


def test_a_leg_is_evaluated_by_hand(stage):
    drive(stage)
    took = ended(LEG, duration=30.0, risk=0.02, charge_used=0.15, discomfort=4.0)
    evaluation = stage.tick(
        **took, action=WORK, leg_report=ActionReport(), place_mismatch=PlaceMismatch("supply_A", 0.0)
    )
    measured = 0.4 * 0.3 + 0.1 * 0.1 + 0.3 * 0.15 + 0.2 * 0.4
    assert (evaluation.action, evaluation.outcome, evaluation.weights) == (LEG, Outcome.SUCCESS, WEIGHTS)
    assert evaluation.prices == pytest.approx((0.4 / 100.0, 0.1 / 0.2, 0.3, 0.2 / 10.0, 0.0))
    assert evaluation.external_reward == pytest.approx(-measured)
    assert evaluation.cost_mismatch == pytest.approx(measured - (0.4 * 0.2 + 0.3 * 0.1))
    assert evaluation.closed_loop_cost == 340.0
    assert evaluation.state_mismatch == 0.25  # Of the state that the leg has reached, not of where the robot is next.


def test_as_predicted_and_as_expected_means_no_mismatch(stage):
    drive(stage, error=0.0)
    took = ended(LEG, predicted=(0.3, 0.1, 0.15, 0.4, 0.0), duration=30.0, risk=0.02, charge_used=0.15, discomfort=4.0)
    evaluation = stage.tick(**took, action=WORK)
    assert evaluation.state_mismatch == 0.0
    assert evaluation.cost_mismatch == pytest.approx(0.0, abs=1e-15)


def test_an_action_in_place_has_no_closed_loop_cost_and_stands_where_it_should(stage):
    stage.tick(action=WORK, place_mismatch=PlaceMismatch("supply_A", 0.5), in_place_report=ActionReport(2))
    done = ActionReport(2, Outcome.SUCCESS)
    stage.tick(place_mismatch=PlaceMismatch("supply_A", 0.0), in_place_report=done)
    evaluation = stage.tick(**ended(WORK, duration=5.0), action=Action(3, ActionKind.MOVE, "go", place="home"))
    assert evaluation.closed_loop_cost is None
    assert evaluation.state_mismatch == 0.0


@pytest.mark.parametrize(
    ("differing", "error"), [((("holding", "robot1"),), 1.0), ((("at", "robot1", "home"),), 0.25), ((), 0.25)]
)
def test_any_other_atom_that_is_not_as_expected_is_a_whole_mismatch(stage, differing, error):
    drive(stage)
    assert stage.tick(**ended(LEG, differing=differing), action=WORK).state_mismatch == error


def test_where_the_place_of_the_robot_is_unknown_it_is_not_the_expected_one(stage):
    drive(stage)
    stage.tick(place_mismatch=PlaceMismatch())
    assert stage.tick(**ended(LEG), action=WORK).state_mismatch == 1.0


def test_a_failed_action_is_evaluated_too(stage):
    drive(stage, error=1.0)
    evaluation = stage.tick(**ended(LEG, outcome=Outcome.BLOCKED, duration=10.0), action=WORK)
    assert evaluation.outcome is Outcome.BLOCKED
    assert evaluation.external_reward == pytest.approx(-0.4 * 0.1)


def test_the_weights_are_those_that_the_action_was_planned_with(stage):
    drive(stage)
    stage.tick(preferences=Preferences(planning=(0.0, 0.0, 0.0, 0.0, 1.0)))
    assert stage.tick(**ended(LEG, duration=10.0), action=WORK).weights == WEIGHTS


def test_the_last_action_of_a_task_is_evaluated_once(stage):
    drive(stage)
    evaluation = stage.tick(**ended(LEG, duration=10.0))  # No other action follows.
    assert evaluation.action == LEG
    assert stage.tick(preferences=Preferences(planning=(0.0, 0.0, 0.0, 0.0, 1.0))) == evaluation
    assert stage.tick(action_features=ActionFeatures(LEG, duration=99.0)) == evaluation


def test_the_looks_of_a_dish_belong_to_its_assembling(stage):
    weights = (0.0, 0.0, 0.0, 0.0, 1.0)
    assemble = Action(1, ActionKind.IN_PLACE, "assemble", ("robot1", "salad"))
    stage.tick(action=assemble, task=Task(1, "meal"), preferences=Preferences(planning=weights))
    looks = DISHES["salad"].presentation_error / SCALES.approach
    took = ended(assemble, predicted=(0.0, 0.0, 0.0, 0.0, looks), duration=14.0)
    evaluation = stage.tick(**took)
    assert evaluation.external_reward == pytest.approx(-looks)
    assert evaluation.cost_mismatch == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("outcome", "pose", "expected"),
    [
        (Outcome.SUCCESS, (0.0, 0.0, math.pi / 2), (0.5 * 0.5 + 0.5 * 0.5) / SCALES.approach),
        (Outcome.SUCCESS, (2.0, 0.0, 0.0), 0.0),
        (Outcome.SUCCESS, (math.nan, 0.0, 0.0), 0.0),
        (Outcome.BLOCKED, (0.0, 0.0, math.pi / 2), 0.0),
    ],
)
def test_the_approach_error_belongs_to_the_leg_to_the_bedside(stage, outcome, pose, expected):
    approach = Action(1, ActionKind.MOVE, "approach_left_to_bed", ("robot1", "home"), place="patient_bed_left")
    preferences = Preferences(planning=(0.0, 0.0, 0.0, 0.0, 1.0))
    stage.tick(pose=pose, action=approach, preferences=preferences, leg_report=ActionReport(1, outcome))
    deliver = Action(2, ActionKind.IN_PLACE, "deliver_on_bedside_table_left", place="patient_bed_left")
    evaluation = stage.tick(pose=pose, **ended(approach, outcome=outcome, duration=30.0), action=deliver)
    assert evaluation.external_reward == pytest.approx(-expected)
    evaluation = stage.tick(pose=pose, **ended(deliver, duration=5.0, approach_error=0.5))
    assert evaluation.external_reward == 0.0
