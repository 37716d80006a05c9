"""A controller on a simulator, its inputs in the test's hands."""

from __future__ import annotations

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

from mala_drake.clock import TICK
from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.control.mpc_controller import MpcController
from mala_drake.control.solver import MakeSolver
from mala_drake.messages import Action, ActionKind, MagnetCommand, Obstacles, Preferences
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.legs import LegPlanner
from mala_drake.ward.ward_map import Ward

HALL = Ward("hall", 10.0, 0.2, 2.0, (), (), (), 0.02)
THERE = (6.0, 0.0, 0.0)
GO = Action(1, ActionKind.MOVE, "go_to_there", ("robot1",), "there")


class ControllerBench:
    """A controller on a simulator, with handles to its inputs."""

    def __init__(self, problem, *, solver=None, rules=None):
        congestion = Congestion(HALL)
        self.system = MpcController(
            targets={"there": THERE},
            guide=LegGuide(LegPlanner(HALL), congestion, HALL.shapes, rules or LegRules()),
            congestion=congestion,
            problem=problem,
            solver=solver or MakeSolver("snopt", problem),
        )
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        fix = lambda name, value: self.system.GetInputPort(name).FixValue(self.context, value)  # noqa: E731
        self.robot_state = fix("robot_state", np.zeros(6))
        self.action = fix("action", Value(Action()))
        self.obstacles = fix("obstacles", Value(Obstacles()))
        self.charge = fix("charge", [1.0])
        self.preferences = fix("preferences", Value(Preferences()))
        self.magnet = fix("magnet", Value(MagnetCommand()))
        self.ticks = 0

    def send(self, action):
        self.action.GetMutableData().set_value(action)

    def place(self, state):
        self.robot_state.GetMutableData().get_mutable_value().SetFromVector(state)

    def tick(self, count=1):
        self.ticks += count
        self.simulator.AdvanceTo(self.ticks * TICK)

    def output(self, name):
        return self.system.GetOutputPort(name).Eval(self.context)
