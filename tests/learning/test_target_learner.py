"""The target learner alone, its inputs fixed, with a leg whose sensitivity is known."""

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
    LearnedTargets,
    MagnetCommand,
    Obstacles,
    Outcome,
    PlaceMismatch,
    Preferences,
    Shape,
)

NOMINAL = {"pantry": (-3.0, 15.0), "stove": (-3.0, 20.5)}
YAWS = {"pantry": 0.0, "stove": 3.0}
MISSING = PlaceMismatch("pantry", 0.25, (-0.25, 0.0), (2.0, 0.0))  # The pantry is 2 m farther east.


def move(sequence, place="pantry"):
    return Action(sequence, ActionKind.MOVE, f"go_to_{place}", ("robot1",), place)


class Bench:
    """A learner on a simulator, with handles to its inputs and a record of the legs that it had simulated."""

    def __init__(self, *, geometric=False, error=None):
        self.legs = []
        self._error = error
        self.learner = TargetEstimator(NOMINAL)
        self.system = mut.TargetLearner(
            learner=self.learner, yaws=YAWS, sensitivity=self._sensitivity, mapped=(), geometric=geometric
        )
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        self._ports = {
            name: self.system.GetInputPort(name).FixValue(self.context, Value(value))
            for name, value in {
                "action": Action(),
                "leg_report": ActionReport(),
                "place_mismatch": PlaceMismatch(),
                "obstacles": Obstacles((Shape("far", 40.0, 40.0, radius=0.1),)),
                "magnet": MagnetCommand(),
                "preferences": Preferences(),
            }.items()
        }
        self._robot_state = self.system.GetInputPort("robot_state").FixValue(self.context, np.zeros(6))

    def _sensitivity(self, initial_state, target, obstacles, **how):
        self.legs.append((tuple(initial_state), target, obstacles, how))
        if self._error:
            raise RuntimeError(self._error)
        return np.eye(2)

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
    ((began, target, obstacles, how),) = bench.legs
    assert began == (0.0, 1.0, 0.1, 0.0, 0.0, 0.0)
    assert target == (-3.0, 15.0, 0.0)
    assert obstacles == seen.shapes
    assert how == {"action": move(1), "carrying": True, "weights": Preferences().estimate}


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


def test_a_leg_that_did_not_stop_at_its_target_teaches_nothing():
    bench = Bench()
    assert bench.drive(1, outcome=Outcome.BLOCKED) == LearnedTargets()
    assert not bench.legs


def test_another_places_mismatch_teaches_nothing():
    bench = Bench()
    assert bench.drive(1, PlaceMismatch("stove", 0.5, (0.25, 0.0), (1.0, 0.0))) == LearnedTargets()


def test_a_leg_without_a_sensitivity_teaches_nothing_and_the_next_one_does():
    bench = Bench(error="has no derivative")
    assert bench.drive(1) == LearnedTargets()
    bench._error = None
    assert bench.drive(2).updates == 1


def test_targets_stay_clear_of_what_is_seen():
    bench = Bench().send(obstacles=Obstacles((Shape("cart", -1.7, 15.0, radius=0.3),)))
    ((_, x, _),) = bench.drive(1).targets
    assert abs(x + 1.7) >= 0.3 + mut.GOAL_DISTANCE


def test_what_was_learned_goes_on_in_a_fresh_context():
    bench = Bench()
    learned = bench.drive(5)
    later = Bench()
    later.system.set_learner_state(later.context, bench.system.learner_state(bench.context), episode=1)
    assert later.tick() == learned
    assert later.drive(1).updates == 2  # Actions are counted anew in each episode.
