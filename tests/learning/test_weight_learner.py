"""The weight learner alone, its inputs fixed, with legs whose gradients are known."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.learning.weight_learner as mut
from mala_drake.clock import TICK
from mala_drake.learning.translation_estimator import TranslationEstimator
from mala_drake.learning.weight_estimator import WeightEstimator
from mala_drake.messages import (
    Action,
    ActionEvaluation,
    ActionKind,
    DrivenLeg,
    LearnedDynamics,
    LearnedTargets,
    LearnedWeights,
    MagnetCommand,
    Obstacles,
    Outcome,
    Preferences,
    Shape,
)

TARGETS = {"pantry": (-3.0, 15.0, 0.0), "stove": (-3.0, 20.5, 3.0)}
WEIGHTS = (0.4, 0.3, 0.1, 0.1, 0.1)
PRICES = (0.004, 1.0, 0.1, 0.01, 0.1)
GRADIENT = np.array([0.1, 0.2, -0.1, 0.0, 0.05, 0.15, -0.3, 0.1, 0.2])
FAR = Shape("far", 40.0, 40.0, radius=0.1)
BEGAN = (1.0, 2.0, 0.3, 0.0, 0.0, 0.0)


def move(sequence, place="pantry"):
    return Action(sequence, ActionKind.MOVE, f"go_to_{place}", ("robot1",), place)


def evaluated(action, mismatch=0.01, outcome=Outcome.SUCCESS):
    return ActionEvaluation(action, outcome, WEIGHTS, PRICES, cost_mismatch=mismatch)


class Bench:
    """A learner on a simulator, with handles to its inputs and a record of the legs that it had simulated."""

    def __init__(self, *, weights=True, translation=False, error=None):
        self.legs = []
        self._error = error
        self.weights = WeightEstimator(tuple(TARGETS)) if weights else None
        self.translation = TranslationEstimator() if translation else None
        self.system = mut.WeightLearner(
            weights=self.weights, translation=self.translation, targets=TARGETS, gradient=self._gradient
        )
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        self._ports = {
            name: self.fix(name, value)
            for name, value in {
                "action": Action(),
                "action_evaluation": ActionEvaluation(),
                "obstacles": Obstacles((FAR,)),
                "magnet": MagnetCommand(),
                "preferences": Preferences(estimate=WEIGHTS),
            }.items()
        }
        self._robot_state = self.system.GetInputPort("robot_state").FixValue(self.context, np.array(BEGAN))

    def fix(self, name, value):
        return self.system.GetInputPort(name).FixValue(self.context, Value(value))

    def _gradient(self, leg, *, prices):
        assert prices == PRICES
        self.legs.append(leg)
        if self._error:
            raise RuntimeError(self._error)
        return GRADIENT

    def tick(self, *, state=BEGAN, **values) -> LearnedWeights:
        self._robot_state.GetMutableData().get_mutable_value().SetFromVector(state)
        for name, value in values.items():
            self._ports[name].GetMutableData().set_value(value)
        self.simulator.AdvanceTo(self.context.get_time() + TICK)
        return self.system.GetOutputPort("learned_weights").Eval(self.context)

    def drive(self, sequence=1, place="pantry", **result):
        """A whole leg, which is evaluated in the tick in which the next action begins."""
        leg = move(sequence, place)
        self.tick(action=leg)
        self.tick(state=(0.0,) * 6)
        work = Action(sequence + 1, ActionKind.IN_PLACE, "collect_ingredient", place=place)
        return self.tick(action=work, action_evaluation=evaluated(leg, **result))


def test_drawn_ports_are_the_real_ports(assert_port_box):
    assert_port_box(Bench().system)


def test_a_leg_is_learned_from_as_the_plain_classes_do():
    bench = Bench(translation=True)
    learned = bench.drive()
    weights = bench.weights.update(bench.weights.initial_state(), "pantry", 0.01, GRADIENT)
    gains = bench.translation.update(bench.translation.initial_state(), WEIGHTS, 0.01, GRADIENT)
    assert learned == LearnedWeights(bench.weights.learned(weights), bench.translation.learned(gains))
    assert learned.factors[0][0] == "pantry"
    assert np.array(learned.gains).shape == (9, 5)


def test_what_is_not_wanted_is_not_learned():
    assert Bench().drive().gains == ()
    assert Bench(weights=False, translation=True).drive().factors == ()


def test_the_leg_is_simulated_as_it_began():
    bench = Bench()
    bench.drive()
    (leg,) = bench.legs
    assert leg == DrivenLeg(move(1), BEGAN, TARGETS["pantry"], obstacles=(FAR,), preferences=WEIGHTS)


def test_it_is_simulated_with_what_the_controller_was_told_when_it_began():
    bench = Bench()
    dynamics = LearnedDynamics((5.0, 0.0, 0.0, 0.9, 1.0, 1.0), (0.1,) * 6, updates=3)
    bench.fix("learned_targets", LearnedTargets((("pantry", -2.5, 15.5),), 1))
    bench.fix("learned_dynamics", dynamics)
    bench.tick(magnet=MagnetCommand((("bread", 0),)))
    first = bench.drive()
    bench.drive(3)
    leg, again = bench.legs
    assert leg.target == (-2.5, 15.5, 0.0)
    assert (leg.carrying, leg.dynamics) == (True, dynamics)
    assert (leg.weights, again.weights) == (LearnedWeights(), first)


def test_a_leg_right_after_another_is_learned_from_too():
    bench = Bench()
    bench.tick(action=move(1))
    bench.tick(action=move(2, "stove"), action_evaluation=evaluated(move(1)), state=(5.0,) * 6)
    learned = bench.tick(action=Action(3, ActionKind.IN_PLACE, "wait"), action_evaluation=evaluated(move(2, "stove")))
    assert [place for place, _ in learned.factors] == ["pantry", "stove"]
    assert [leg.initial_state for leg in bench.legs] == [BEGAN, (5.0,) * 6]
    assert [leg.weights for leg in bench.legs] == [LearnedWeights()] * 2  # The controller had not been told others.


def test_a_leg_is_learned_from_once():
    bench = Bench()
    once = bench.drive()
    assert bench.tick() == once
    assert len(bench.legs) == 1


@pytest.mark.parametrize("outcome", [Outcome.BLOCKED, Outcome.STEP_BUDGET])
def test_a_leg_that_failed_teaches_nothing(outcome):
    bench = Bench()
    assert bench.drive(outcome=outcome) == LearnedWeights()
    assert bench.legs == []


def test_an_action_in_place_teaches_nothing():
    bench = Bench()
    work = Action(1, ActionKind.IN_PLACE, "recharge", place="pantry")
    bench.tick(action=work)
    assert bench.tick(action_evaluation=evaluated(work)) == LearnedWeights()


def test_a_leg_without_a_gradient_teaches_nothing_and_the_next_one_does(caplog):
    bench = Bench(error="ended as blocked")
    with caplog.at_level("INFO"):
        assert bench.drive() == LearnedWeights()
    assert "the leg to pantry: simulated, it ended as blocked" in caplog.text
    bench._error = None
    assert bench.drive(3).factors


def test_what_was_learned_goes_on_in_a_fresh_context():
    bench = Bench(translation=True)
    learned = bench.drive()
    state = bench.system.learner_state(bench.context)
    later = Bench(translation=True)
    later.system.set_learner_state(later.context, state, episode=1)
    assert later.tick() == learned
    assert later.drive() != learned  # Actions are counted anew in each episode.
    assert later.system.learner_state(later.context).shape == state.shape
