import math

import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.robot.in_place_executor as mut
from mala_drake.clock import TICK
from mala_drake.messages import Action, ActionKind, ArmCommand, MagnetCommand, Outcome
from mala_drake.robot.arm_kinematics import STOWED
from mala_drake.robot.in_place_motions import HOVER_HEIGHT
from mala_drake.robot.item_messages import HandedItem
from mala_drake.ward.items import all_items

MEDICINE = "pharmacy_north/med_antibiotic"


class Stage:
    """An executor whose inputs are in the test's hands; the robot stands where it is told, its arm does not move."""

    def __init__(self, ward, place):
        here = ward.place[place]
        self.executor = mut.InPlaceExecutor(ward)
        self.simulator = Simulator(self.executor)
        self.context = self.simulator.get_mutable_context()
        positions = [v for i in all_items(ward) for v in (i.shelf_pose.x, i.shelf_pose.y, i.shelf_pose.z)]
        self.action = self._fix("action", Value(Action()))
        self.robot_state = self._fix("robot_state", [here.x, here.y, here.yaw, 0.0, 0.0, 0.0])
        self.handed = self._fix("handed_item", Value(HandedItem()))
        self._fix("item_positions", positions)
        self._fix("arm_state", [*STOWED, 0.0, 0.0, 0.0])
        self.charge = self._fix("charge", [0.5])

    def _fix(self, name, value):
        return self.executor.GetInputPort(name).FixValue(self.context, value)

    def output(self, name):
        return self.executor.GetOutputPort(name).Eval(self.context)

    def begin(self, sequence, name, place, kind=ActionKind.IN_PLACE):
        self.action.GetMutableData().set_value(Action(sequence, kind, name, ("robot1",), place, place))

    def advance(self, seconds):
        self.simulator.AdvanceTo(self.context.get_time() + seconds)


def test_drawn_ports_are_the_real_ports(ward, assert_port_box):
    assert_port_box(mut.InPlaceExecutor(ward))


def test_at_first_nothing_has_been_done(ward):
    stage = Stage(ward, "home")
    assert not stage.output("in_place_report").finished
    assert stage.output("in_place_report").sequence == 0
    assert stage.output("arm_target") == ArmCommand()
    assert stage.output("magnet") == MagnetCommand()
    assert stage.output("charge_rates") == pytest.approx([0.0, 0.0])


def test_recharging_is_reported_when_its_time_is_over(ward):
    stage = Stage(ward, "charge_main")
    stage.begin(1, "recharge", "charge_main")
    stage.advance(TICK / 2)
    assert stage.output("in_place_report").outcome is Outcome.RUNNING
    assert stage.output("charge_rates")[1] * 30.0 > 0.5
    stage.charge.GetMutableData().get_mutable_value().SetAtIndex(0, 1.0)
    stage.advance(29.8)
    assert not stage.output("in_place_report").finished
    stage.advance(TICK)
    report = stage.output("in_place_report")
    assert (report.sequence, report.outcome, report.steps) == (1, Outcome.SUCCESS, 150)
    assert stage.output("charge_rates") == pytest.approx([0.0, 0.0])


def test_a_charger_that_does_not_charge_is_told(ward):
    stage = Stage(ward, "charge_main")
    stage.begin(1, "recharge", "charge_main")
    stage.advance(31.0)
    report = stage.output("in_place_report")
    assert report.outcome is Outcome.OUT_OF_REACH
    assert "0.50" in report.detail


def test_collecting_reaches_for_the_box_and_draws_its_charge(ward):
    stage = Stage(ward, "pharmacy_north")
    stage.begin(1, "collect_med_antibiotic", "pharmacy_north")
    stage.handed.GetMutableData().set_value(HandedItem(1, MEDICINE))
    stage.advance(1.0)
    assert stage.output("charge_rates") == pytest.approx([0.01, 0.0])
    x, y, z = stage.output("arm_target").p_BG
    assert math.hypot(x - 0.70, y - 0.24) < 0.08
    assert z == pytest.approx(0.83 + 0.05 + 0.02 + HOVER_HEIGHT)


def test_a_move_is_none_of_its_business(ward):
    stage = Stage(ward, "home")
    stage.begin(1, "go_to_pharmacy_north", "pharmacy_north", kind=ActionKind.MOVE)
    stage.advance(1.0)
    assert stage.output("in_place_report").sequence == 0


def test_a_sequence_number_starts_an_action_once(ward):
    stage = Stage(ward, "home")
    stage.begin(1, "put_down_medicine", "home")
    stage.advance(2.0)
    report = stage.output("in_place_report")
    assert report.finished
    assert report.outcome is Outcome.NOT_THERE
    stage.begin(1, "recharge", "charge_main")
    stage.advance(1.0)
    assert stage.output("in_place_report") == report


def test_a_newer_action_is_told_apart(ward):
    stage = Stage(ward, "charge_main")
    stage.begin(1, "recharge", "charge_main")
    stage.advance(1.0)
    stage.begin(2, "check_medication_correct", "charge_main")
    stage.advance(TICK)
    report = stage.output("in_place_report")
    assert (report.sequence, report.outcome) == (2, Outcome.NOT_THERE)


def test_a_broken_estimate_is_reported(ward):
    stage = Stage(ward, "charge_main")
    stage.begin(1, "recharge", "charge_main")
    stage.advance(1.0)
    stage.robot_state.GetMutableData().get_mutable_value().SetAtIndex(0, math.nan)
    stage.advance(TICK)
    assert stage.output("in_place_report").outcome is Outcome.INVALID_STATE
