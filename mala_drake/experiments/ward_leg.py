"""Legs between places of the ward, recorded as the controller drives them."""

from __future__ import annotations

from mala_drake.control import OptimalControlProblem, Solver
from mala_drake.control.action_parameters import EMPTY_HANDED
from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.control.sensitivities.recorded_leg import LegRecorder, RecordedLeg
from mala_drake.preferences import CRITERIA
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.legs import leg_planner
from mala_drake.ward.ward_map import Ward


def record_leg(problem: OptimalControlProblem, solver: Solver, ward: Ward, start: str, goal: str) -> RecordedLeg:
    """Drives from place to place over the prediction model until the robot has stopped.

    Raises:
        RuntimeError: the leg did not succeed.
    """
    congestion = Congestion(ward)
    recorder = LegRecorder(
        problem, solver, LegGuide(leg_planner(ward), congestion, ward.shapes, LegRules()), congestion
    )
    a, b = ward.place[start], ward.place[goal]
    try:
        return recorder.record(
            (a.x, a.y, a.yaw, 0.0, 0.0, 0.0),
            (b.x, b.y, b.yaw),
            ward.shapes,
            style=EMPTY_HANDED,
            weights=(1 / len(CRITERIA),) * len(CRITERIA),
        )
    except RuntimeError as error:
        raise RuntimeError(f"the leg from {start} to {goal} {error}") from None
