"""The target learner alone, its inputs fixed, with a leg whose sensitivity is known."""

import math

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.learning.target_learner as mut
from mala_drake.learning.target_estimator import TargetEstimator
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    DrivenLeg,
    LearnedDynamics,
    LearnedTargets,
    LearnedWeights,
    MagnetCommand,
    Obstacles,
    Outcome,
    PlaceMismatch,
    Preferences,
    SensitivitySource,
    Shape,
)

NOMINAL = {"pantry": (-3.0, 15.0), "stove": (-3.0, 20.5)}
YAWS = {"pantry": 0.0, "stove": 3.0}
MISSING = PlaceMismatch("pantry", 0.25, (-0.25, 0.0), (2.0, 0.0))  # The pantry is 2 m farther east.


AT_PANTRY = PlaceMismatch("pantry")
SHORT = PlaceMismatch("pantry", 0.1, (0.0, -0.25))  # The arm falls 0.4 m short, to the north.


def move(sequence, place="pantry"):
    return Action(sequence, ActionKind.MOVE, f"go_to_{place}", ("robot1",), place)


class Bench:
    """A learner on a simulator, with handles to its inputs and a record of the legs that it had simulated."""

    def __init__(self, *, geometric=False, error=None, simulated=((1.0, 0.0), (0.0, 1.0)), identity=False):
        self.legs = []
        self._error = error
        self._simulated = np.array(simulated)
        self.learner = TargetEstimator(NOMINAL)
        self.system = mut.TargetLearner(
            learner=self.learner,
            yaws=YAWS,
            sensitivity=None if identity else self._sensitivity,
            mapped=(),
            geometric=geometric,
        )
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        self._ports = {
            name: self.system.GetInputPort(name).FixValue(self.context, Value(value))
            for name, value in {
                "action": Action(),
                "leg_report": ActionReport(),
                "in_place_report": ActionReport(),
                "place_mismatch": PlaceMismatch(),
                "reach_mismatch": PlaceMismatch(),
                "obstacles": Obstacles((Shape("far", 40.0, 40.0, radius=0.1),)),
                "magnet": MagnetCommand(),
                "preferences": Preferences(),
            }.items()
        }
        self._robot_state = self.system.GetInputPort("robot_state").FixValue(self.context, np.zeros(6))

    def _sensitivity(self, leg):
        self.legs.append(leg)
        if self._error:
            raise RuntimeError(self._error)
        return self._simulated

    def send(self, **messages):
        for name, message in messages.items():
            self._ports[name].GetMutableData().set_value(message)
        return self

    def place(self, x, y):
        self._robot_state.GetMutableData().get_mutable_value().SetFromVector([x, y, 0.1, 0.0, 0.0, 0.0])
        return self

    def tick(self) -> LearnedTargets:
        self.simulator.AdvanceTo(self.context.get_time() + 1.0)
        return self.system.GetOutputPort("learned_targets").Eval(self.context)

    def work(self, sequence, reach, mismatch=AT_PANTRY, outcome=Outcome.OUT_OF_REACH) -> LearnedTargets:
        """An action in place at the pantry, which finds its things `reach`."""
        collect = Action(sequence, ActionKind.IN_PLACE, "collect_ingredient", ("robot1",), "pantry", "pantry")
        self.send(action=collect, in_place_report=ActionReport(sequence), place_mismatch=mismatch).tick()
        return self.send(in_place_report=ActionReport(sequence, outcome), reach_mismatch=reach).tick()

    def drive(self, sequence, mismatch=MISSING, outcome=Outcome.SUCCESS) -> LearnedTargets:
        self.place(0.0, 1.0).send(action=move(sequence), leg_report=ActionReport(sequence)).tick()
        self.place(-3.0, 15.0).send(leg_report=ActionReport(sequence, outcome), place_mismatch=mismatch)
        return self.tick()


def test_drawn_ports_are_the_real_ports(assert_port_box):
    assert_port_box(Bench().system)


def test_a_leg_is_learned_from_as_the_plain_class_does():
    bench = Bench()
    assert bench.tick() == LearnedTargets()
    ((place, x, y),) = bench.drive(1).targets
    assert (place, x, y) == ("pantry", pytest.approx(-3.0 + 1.0 + 0.3), pytest.approx(15.0))


def test_the_leg_that_is_simulated_is_the_one_that_was_driven():
    bench = Bench()
    seen = Obstacles((Shape("cart", 9.0, 9.0, radius=0.3),))
    bench.send(magnet=MagnetCommand((("box", 0),)), obstacles=seen).drive(1)
    (leg,) = bench.legs
    assert leg == DrivenLeg(move(1), (0.0, 1.0, 0.1, 0.0, 0.0, 0.0), (-3.0, 15.0, 0.0), True, seen.shapes)


def test_the_leg_is_simulated_over_the_dynamics_that_were_learned():
    bench, learned = Bench(), LearnedDynamics((5.0, 0.0, 0.1, 1.0, 1.0, 0.9), (0.1,) * 6, 40)
    bench.system.GetInputPort("learned_dynamics").FixValue(bench.context, Value(learned))
    bench.drive(1)
    assert bench.legs[0].dynamics == learned


def test_the_leg_is_simulated_with_the_weights_that_it_was_driven_with():
    bench, told = Bench(), LearnedWeights((("pantry", (2.0, 1.0, 0.5, 1.0)),))
    port = bench.system.GetInputPort("learned_weights").FixValue(bench.context, Value(told))
    bench.send(action=move(1), leg_report=ActionReport(1)).tick()
    port.GetMutableData().set_value(LearnedWeights())  # Those are for the next leg.
    bench.send(leg_report=ActionReport(1, Outcome.SUCCESS), place_mismatch=MISSING).tick()
    bench.drive(2)
    assert [leg.weights for leg in bench.legs] == [told, LearnedWeights()]


def test_the_place_as_it_is_seen_counts_only_if_wanted():
    ((_, fuzzy, _),) = Bench().drive(1).targets
    ((_, geometric, _),) = Bench(geometric=True).drive(1).targets
    assert fuzzy == pytest.approx(-1.7)
    assert geometric == pytest.approx(-1.0, abs=0.1)


def test_a_leg_is_learned_from_once_however_long_its_report_stands():
    bench = Bench()
    once = bench.drive(1)
    assert bench.tick() == once
    assert bench.drive(2).updates == 2
    assert len(bench.legs) == 2


@pytest.mark.parametrize("mismatch", [PlaceMismatch("pantry", 0.0, (0.0, 0.0), (0.5, 0.0)), PlaceMismatch()])
def test_where_nothing_is_missing_no_leg_is_simulated(mismatch):
    bench = Bench()
    assert bench.drive(1, mismatch) == LearnedTargets()
    assert not bench.legs


@pytest.mark.parametrize("outcome", [Outcome.BLOCKED, Outcome.SOLVER_FAILURE, Outcome.BATTERY_EMPTY])
def test_a_leg_that_did_not_stop_at_its_target_teaches_nothing_by_its_mismatch(outcome):
    bench = Bench()
    assert bench.drive(1, outcome=outcome) == LearnedTargets()
    assert not bench.legs


def test_what_is_seen_of_the_place_counts_wherever_a_leg_has_failed():
    bench = Bench(geometric=True)
    bench.place(-3.0, 15.0).send(action=move(1), leg_report=ActionReport(1)).tick()
    bench.place(-5.0, 15.5).send(leg_report=ActionReport(1, Outcome.BLOCKED))
    ((_, x, y),) = bench.send(place_mismatch=PlaceMismatch("pantry", 0.4, (-0.25, 0.0), (2.0, 1.0))).tick().targets
    assert (x, y) == pytest.approx((-3.0, 16.5), abs=0.1)
    assert not bench.legs
    assert bench.tick().sensitivity is SensitivitySource.NOT_NEEDED
    assert Bench(geometric=True).drive(1, outcome=Outcome.SOLVER_FAILURE) == LearnedTargets()


def test_a_target_where_something_stands_is_given_up_even_by_the_mismatch_alone():
    bench = Bench().send(obstacles=Obstacles((Shape("cart", -3.0, 15.0, radius=0.5),)))
    bench.place(-6.0, 15.0).send(action=move(1), leg_report=ActionReport(1)).tick()
    bench.place(-5.0, 15.0).send(leg_report=ActionReport(1, Outcome.BLOCKED), place_mismatch=MISSING)
    ((_, x, y),) = bench.tick().targets
    assert math.dist((x, y), (-3.0, 15.0)) >= 0.5 + mut.STANDING_DISTANCE
    assert x >= -5.0 + 1.3  # As far from the robot towards the place as is missing.


def test_what_is_out_of_reach_moves_the_target_of_the_leg_before():
    bench = Bench()
    bench.drive(1, AT_PANTRY)
    ((_, x, y),) = bench.work(2, SHORT).targets
    assert (x, y) == pytest.approx((-3.0, 15.0 + 0.4 + 0.15))
    (leg,) = bench.legs  # It is simulated, once that is needed.
    assert (leg.initial_state[:2], leg.target, leg.action) == ((0.0, 1.0), (-3.0, 15.0, 0.0), move(1))


def test_reach_and_place_are_minded_at_once():
    bench = Bench()
    bench.drive(1, MISSING)
    ((_, x, y),) = bench.work(2, SHORT, mismatch=MISSING).targets
    assert (x, y) == pytest.approx((-3.0 + 1.3, 15.0 + 0.55))


@pytest.mark.parametrize("outcome", [Outcome.SUCCESS, Outcome.NOT_THERE, Outcome.CANCELLED])
def test_other_ends_of_actions_in_place_teach_nothing(outcome):
    bench = Bench()
    bench.drive(1, AT_PANTRY)
    assert bench.work(2, SHORT, outcome=outcome) == LearnedTargets()


def test_reach_is_not_needed_where_the_place_is_seen():
    bench = Bench(geometric=True)
    learned = bench.drive(1)
    assert bench.work(2, SHORT) == learned


def test_reach_teaches_nothing_about_another_place_than_the_leg_led_to():
    bench = Bench()
    bench.drive(1, AT_PANTRY)
    assert bench.work(2, PlaceMismatch("stove", 0.1, (0.0, -0.25))) == LearnedTargets()


def test_another_places_mismatch_teaches_nothing():
    bench = Bench()
    assert bench.drive(1, PlaceMismatch("stove", 0.5, (0.25, 0.0), (1.0, 0.0))) == LearnedTargets()


def test_of_a_leg_without_a_sensitivity_the_end_is_where_the_target_was():
    bench = Bench(error="has no derivative")
    assert bench.drive(1).targets == Bench().drive(1).targets


@pytest.mark.parametrize("geometric", [False, True])
def test_an_update_tells_the_sensitivity_that_it_went_through(geometric):
    told = Bench(simulated=((1.0, 0.0), (0.0, 1.3)), geometric=geometric).drive(1)
    assert (told.sensitivity, told.deviation) == (SensitivitySource.SIMULATED, pytest.approx(0.3))
    for bench, deviation in ((Bench(error="fails"), None), (Bench(simulated=((0.2, 0.0), (0.0, 1.0))), 0.8)):
        told = bench.drive(1)
        assert (told.sensitivity, told.deviation) == (SensitivitySource.FALLBACK, deviation)


def test_it_is_told_until_the_next_update_and_not_beyond_the_episode():
    bench = Bench(simulated=((1.0, 0.0), (0.0, 1.3)))
    told = bench.drive(1)
    assert bench.drive(2, AT_PANTRY) == told
    later = Bench()
    later.system.set_learner_state(later.context, bench.system.learner_state(bench.context), episode=1)
    assert later.tick().sensitivity is SensitivitySource.NONE
    assert later.tick().deviation is None


def test_reach_is_learned_through_the_sensitivity_as_well():
    bench = Bench(simulated=((1.0, 0.0), (0.0, 0.8)))
    assert bench.drive(1, AT_PANTRY).sensitivity is SensitivitySource.NONE
    told = bench.work(2, SHORT)
    assert (told.sensitivity, told.deviation) == (SensitivitySource.SIMULATED, pytest.approx(0.2))


def test_with_the_identity_no_leg_is_simulated_and_the_end_moves_as_the_target():
    bench = Bench(identity=True)
    told = bench.drive(1)
    assert told.targets == Bench().drive(1).targets
    assert told.targets != Bench(simulated=((1.4, 0.0), (0.0, 1.0))).drive(1).targets
    assert (told.sensitivity, told.deviation) == (SensitivitySource.IDENTITY, None)
    assert not bench.legs


def test_targets_stay_clear_of_what_is_seen():
    bench = Bench().send(obstacles=Obstacles((Shape("cart", -1.7, 15.0, radius=0.3),)))
    ((_, x, y),) = bench.drive(1).targets
    assert math.dist((x, y), (-1.7, 15.0)) >= 0.3 + mut.STANDING_DISTANCE


def test_what_was_learned_goes_on_in_a_fresh_context():
    bench = Bench()
    learned = bench.drive(5)
    later = Bench()
    later.system.set_learner_state(later.context, bench.system.learner_state(bench.context), episode=1)
    assert later.tick().targets == learned.targets
    assert later.drive(1).updates == 2  # Actions are counted anew in each episode.
