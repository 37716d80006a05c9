"""A short leg in an empty hall, and who drives it."""

from __future__ import annotations

from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.control.solver_by_horizon import solver_of_kind
from mala_drake.messages import Action, ActionKind
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.legs import LegPlanner
from mala_drake.ward.ward_map import Ward

HALL = Ward("hall", 10.0, 0.2, 2.0, (), (), (), 0.02)
THERE = (2.0, 0.6, 0.5)
GO = Action(1, ActionKind.MOVE, "go_to_there", ("robot1",), "there")


def make_guide(rules=None):
    """Who decides about legs, and the congestion that it knows."""
    congestion = Congestion(HALL)
    return LegGuide(LegPlanner(HALL), congestion, HALL.shapes, rules or LegRules()), congestion


def make(system, problem, rules=None, *, kind="receding"):
    """Who drives legs, a recorder or a simulator, with what a controller has."""
    solver, shortest = solver_of_kind(kind, "rti", problem)
    return system(problem, solver, *make_guide(rules), shortest_horizon=shortest)
