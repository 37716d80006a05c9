"""How legs are remembered, on a learner that learns nothing and tells what it remembers."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

import mala_drake.learning.leg_learner as mut
from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.messages import (
    Action,
    ActionKind,
    DrivenLeg,
    LearnedDynamics,
    LearnedWeights,
    MagnetCommand,
    Obstacles,
    Preferences,
    Ratings,
    Shape,
)

TARGETS = {"pantry": (-3.0, 15.0, 0.5), "stove": (-3.0, 20.5, 3.0)}
CART = Shape("cart", 9.0, 9.0, radius=0.3)
WEIGHTS = (0.4, 0.3, 0.1, 0.1, 0.1)
DYNAMICS = LearnedDynamics((5.0, 0.0, 0.1, 1.0, 1.0, 0.9), (0.1,) * 6, 40)


class Listener(mut.LegLearner):
    def __init__(self):
        super().__init__()
        self._declare_legs()
        self._declare_learned("learned", Ratings(), initial_state=np.zeros(1), marks=0)
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._look)
        self.seen_by_updates = []

    def _target(self, context, place):
        return TARGETS.get(place, (0.0, 0.0, 0.0))

    def _weights_told(self, context):
        return LearnedWeights((("pantry", (float(len(self.seen_by_updates)), 1.0, 1.0, 1.0)),))

    def _look(self, context, discrete_state):
        self.seen_by_updates.append(self._newest_leg(context).action)

    def newest(self, context):
        return self._newest_leg(context)

    def of(self, context, action):
        return self._leg_of(context, action)


class Bench:
    """The listener on a simulator, with handles to its inputs."""

    def __init__(self):
        self.system = Listener()
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        values = {
            "action": Action(),
            "obstacles": Obstacles(),
            "magnet": MagnetCommand(),
            "preferences": Preferences(),
        }
        self._ports = {name: self.fix(name, value) for name, value in values.items()}
        self._robot_state = self.system.GetInputPort("robot_state").FixValue(self.context, np.zeros(6))

    def fix(self, name, value):
        return self.system.GetInputPort(name).FixValue(self.context, Value(value))

    def tick(self, *, x=0.0, **values) -> DrivenLeg:
        self._robot_state.GetMutableData().get_mutable_value().SetFromVector([x, 0.0, 0.0, 0.0, 0.0, 0.0])
        for name, value in values.items():
            self._ports[name].GetMutableData().set_value(value)
        self.simulator.AdvanceTo(self.context.get_time() + TICK)
        return self.system.newest(self.context)


@pytest.fixture
def bench():
    return Bench()


def move(sequence, place="pantry"):
    return Action(sequence, ActionKind.MOVE, f"go_to_{place}", ("robot1",), place)


def test_before_the_first_leg_there_is_none(bench):
    assert bench.tick() == DrivenLeg()
    assert bench.system.of(bench.context, Action()) is None


def test_a_leg_is_remembered_as_it_began(bench):
    leg = bench.tick(action=move(1), x=2.0, magnet=MagnetCommand((("bread", 0),)))
    weights = LearnedWeights((("pantry", (0.0, 1.0, 1.0, 1.0)),))  # Those before the learner's own update.
    began = (2.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert leg == DrivenLeg(move(1), began, TARGETS["pantry"], carrying=True, weights=weights)
    assert bench.tick(x=3.0, magnet=MagnetCommand()) == leg


def test_what_is_seen_wanted_and_known_is_that_of_now(bench):
    bench.tick(action=move(1))
    bench.fix("learned_dynamics", DYNAMICS)
    leg = bench.tick(obstacles=Obstacles((CART,)), preferences=Preferences(estimate=WEIGHTS))
    assert (leg.obstacles, leg.preferences, leg.dynamics) == ((CART,), WEIGHTS, DYNAMICS)


def test_an_action_in_place_leaves_the_leg_before_it(bench):
    leg = bench.tick(action=move(1), x=2.0)
    assert bench.tick(action=Action(2, ActionKind.IN_PLACE, "wait"), x=4.0) == leg


def test_two_legs_are_remembered(bench):
    first = bench.tick(action=move(1), x=1.0)
    second = bench.tick(action=move(2, "stove"), x=2.0)
    assert (first.action, second.action, second.target) == (move(1), move(2, "stove"), TARGETS["stove"])
    assert bench.system.of(bench.context, move(1)) == first
    assert bench.system.of(bench.context, move(2, "stove")) == second
    bench.tick(action=move(3))
    assert bench.system.of(bench.context, move(1)) is None


def test_a_leg_to_where_nobody_knows_is_a_leg_all_the_same(bench):
    assert bench.tick(action=move(1, "nowhere")).target == (0.0, 0.0, 0.0)


def test_who_learns_knows_of_a_leg_in_the_tick_in_which_it_begins(bench):
    bench.tick()
    bench.tick(action=move(1))
    assert bench.system.seen_by_updates == [Action(), move(1)]
