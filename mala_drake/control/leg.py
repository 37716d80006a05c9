"""One leg of the robot: where it is on its way, and whether and how it has ended.

A leg goes along a collision-free path to a pose and stops there. It ends by success, by an exhausted allocation of
iterations to the next waypoint or of steps to the leg, or by a blocked way (paper, Sec. "Stopping Criteria"). A robot
that stands still beside its target turns or creeps back to it; one found far from its path gets a new one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mala_drake.messages import Message, Outcome, Shape
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.drive_path import make_drive_path
from mala_drake.ward.legs import LegPlanner
from mala_drake.ward.routes import BODY_RADIUS, Route
from mala_drake.ward.shapes import ShapeDistances

from .model import StateIndex
from .optimal_control_problem import OptimalControlProblem
from .reference import Reference, Track, make_reference, needs_turn

Pose = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class LegRules:
    """When a leg ends. Distances in metres, angles in radians, speeds in metres (radians) per second."""

    position_tolerance: float = 0.10
    yaw_tolerance: float = 0.12
    speed_tolerance: float = 0.03
    yaw_rate_tolerance: float = 0.05
    waypoint_spacing: float = 1.5
    waypoint_iterations: int = 50
    step_budget: int = 400
    tolerated_failures: int = 5  # Of the solver, or of the state estimate, in a row.
    approaches: int = 4  # Tries to stop at the target before the leg has failed.


@dataclass(frozen=True, slots=True, eq=False)
class Leg(Message):
    """A leg on its way. `unmapped` are the shapes met on it that the map does not know."""

    target: Pose
    track: Track | None
    length: float = 0.0  # Arc length reached.
    turning: bool = False
    steps: int = 0
    waypoint: float = 0.0  # Arc length of the next waypoint.
    iterations: int = 0  # Since the last waypoint.
    still: int = 0  # Steps in a row without movement.
    approaches: int = 1
    unmapped: tuple[Shape, ...] = ()
    outcome: Outcome = Outcome.RUNNING
    detail: str = ""

    def reference(
        self, state: NDArray[np.float64], problem: OptimalControlProblem, shortest_horizon: int | None
    ) -> Reference:
        """The reference of the horizon that begins now; the leg has a track.

        Args:
            state: the robot's state z, shape (6,).
            problem: that is to be solved.
            shortest_horizon: if given, the horizon shrinks to the end of the leg, but to no fewer stages.
        """
        assert self.track is not None
        whole = make_reference(
            self.track, state, self.length, turning=self.turning, horizon=problem.horizon, period=problem.period
        )
        return whole if shortest_horizon is None else whole.until_rest(shortest_horizon)


def pose_errors(state: NDArray[np.float64], target: Pose) -> tuple[float, float]:
    """Position error in metres and absolute yaw error in radians of a state z, shape (6,)."""
    position = math.hypot(state[StateIndex.X] - target[0], state[StateIndex.Y] - target[1])
    return position, abs(math.remainder(state[StateIndex.YAW] - target[2], math.tau))


class LegGuide:
    """Decides about legs on one ward."""

    def __init__(self, legs: LegPlanner, congestion: Congestion, mapped: Iterable[Shape], rules: LegRules) -> None:
        self._legs = legs
        self._congestion = congestion
        self._mapped = frozenset(mapped)
        self.rules = rules

    def begin(self, target: Pose, state: NDArray[np.float64], seen: Iterable[Shape]) -> Leg:
        """A new leg to `target` from `state`, round what the sensor has `seen`."""
        unmapped = self._unmapped((), seen)
        return self._on_new_track(Leg(target, None, unmapped=unmapped), state)

    def advance(self, leg: Leg, state: NDArray[np.float64], seen: Iterable[Shape]) -> Leg:
        """The leg one control step later, ended if one of the rules says so."""
        rules = self.rules
        leg = replace(leg, steps=leg.steps + 1, iterations=leg.iterations + 1, still=self._still_steps(leg, state))
        leg = self._keep_clear(leg, state, seen)
        if leg.outcome is not Outcome.RUNNING:
            return leg
        leg = self._follow(leg, state)
        if leg.outcome is not Outcome.RUNNING:
            return leg
        if self._is_stopped(leg, state):
            return replace(leg, outcome=Outcome.SUCCESS)
        if leg.steps >= rules.step_budget:
            return replace(leg, outcome=Outcome.STEP_BUDGET, detail=f"{leg.steps} control steps")
        if leg.iterations >= rules.waypoint_iterations:
            detail = f"no waypoint reached in {leg.iterations} iterations"
            return replace(leg, outcome=Outcome.WAYPOINT_ALLOCATION, detail=detail)
        return leg

    def _unmapped(self, known: tuple[Shape, ...], seen: Iterable[Shape]) -> tuple[Shape, ...]:
        new = [shape for shape in seen if shape not in self._mapped and shape not in known]
        return (*known, *new) if new else known

    def _keep_clear(self, leg: Leg, state: NDArray[np.float64], seen: Iterable[Shape]) -> Leg:
        """Replans round shapes that have come into view and stand in the way."""
        unmapped = self._unmapped(leg.unmapped, seen)
        track = leg.track
        if unmapped is leg.unmapped or track is None:
            return leg
        leg = replace(leg, unmapped=unmapped)
        ahead = track.path.points[np.searchsorted(track.path.lengths, leg.length) :]
        if ShapeDistances(unmapped)(ahead).min() > BODY_RADIUS + _REPAIR_CLEARANCE:
            return leg
        return self._on_new_track(leg, state)

    def _follow(self, leg: Leg, state: NDArray[np.float64]) -> Leg:
        """Moves on along the track, or gets a new one for a robot that is lost or stands beside its target."""
        if leg.track is None:
            return leg
        position = state[[StateIndex.X, StateIndex.Y]]
        length, distance = leg.track.progress(position, leg.length)
        if distance > _LOST:
            return self._on_new_track(leg, state)
        if leg.still >= _STALLED:
            if leg.approaches >= self.rules.approaches:
                return replace(leg, outcome=Outcome.WAYPOINT_ALLOCATION, detail="stands beside its target")
            return self._on_new_track(replace(leg, approaches=leg.approaches + 1), state)
        turning = needs_turn(leg.track, float(state[StateIndex.YAW]), length, turning=leg.turning)
        if length >= leg.waypoint:
            waypoint = min(length + self.rules.waypoint_spacing, leg.track.path.length)
            # The last waypoint is the target itself: time to settle there is counted once.
            iterations = leg.iterations if leg.waypoint >= leg.track.path.length else 0
            return replace(leg, length=length, turning=turning, waypoint=waypoint, iterations=iterations)
        return replace(leg, length=length, turning=turning)

    def _on_new_track(self, leg: Leg, state: NDArray[np.float64]) -> Leg:
        position = (float(state[StateIndex.X]), float(state[StateIndex.Y]))
        route = self._legs.to_pose(position, leg.target, unmapped=leg.unmapped)
        if route is None:
            names = ", ".join(shape.name for shape in leg.unmapped) or "the map"
            return replace(leg, track=None, outcome=Outcome.BLOCKED, detail=f"no free way: {names}")
        track = self._track(route, leg.target, float(state[StateIndex.YAW]))
        turning = needs_turn(track, float(state[StateIndex.YAW]), 0.0, turning=False)
        waypoint = min(self.rules.waypoint_spacing, track.path.length)
        return replace(leg, track=track, length=0.0, turning=turning, waypoint=waypoint, iterations=0, still=0)

    def _track(self, route: Route, target: Pose, yaw: float) -> Track:
        path = make_drive_path(route, self._congestion)
        behind = abs(math.remainder(float(path.headings[0]) - yaw, math.tau)) > math.pi / 2
        return Track(path, target[2], reverse=behind and path.length < _CREEP_BACK)

    def _still_steps(self, leg: Leg, state: NDArray[np.float64]) -> int:
        """Control steps in a row without movement, this one included; those at the start of a track count, too."""
        moving = abs(state[StateIndex.FORWARD_VELOCITY]) > _STILL or abs(state[StateIndex.YAW_RATE]) > _STILL
        return 0 if moving else leg.still + 1

    def _is_stopped(self, leg: Leg, state: NDArray[np.float64]) -> bool:
        position, yaw = pose_errors(state, leg.target)
        rules = self.rules
        return (
            position <= rules.position_tolerance
            and yaw <= rules.yaw_tolerance
            and abs(state[StateIndex.FORWARD_VELOCITY]) <= rules.speed_tolerance
            and abs(state[StateIndex.YAW_RATE]) <= rules.yaw_rate_tolerance
        )


_REPAIR_CLEARANCE = 0.15  # Metres between body and a new obstacle under which the way is planned anew.
_LOST = 0.8  # Metres from the path beyond which it is no longer followed.
_STILL = 0.02  # Metres and radians per second that count as standing.
_STALLED = 10  # Control steps of standing before another approach.
_CREEP_BACK = 0.8  # Metres of the longest way driven in reverse.
