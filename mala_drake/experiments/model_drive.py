"""Closed loops over the prediction model: a way to go, what is in it, and a solver in the loop."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mala_drake.clock import TICK
from mala_drake.control import MpcParameters, OptimalControlProblem, Solution, Solver
from mala_drake.control.action_parameters import DrivingStyle, make_parameters
from mala_drake.control.model import StateIndex
from mala_drake.control.reference import Track, make_reference, needs_turn
from mala_drake.control.rti import RealTimeIterationSolver
from mala_drake.control.tracking_cost import stage_cost
from mala_drake.messages import Preferences, Shape
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.routes import BODY_RADIUS
from mala_drake.ward.shapes import ShapeDistances

Vector = NDArray[np.float64]
_Result = TypeVar("_Result")

NOISE = np.array([0.004, 0.004, 0.004, 0.02, 0.0, 0.02])
"""Standard deviations of the state per step: they stand for everything that the model does not know."""


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """A way to go."""

    name: str
    track: Track
    start_yaw: float
    shapes: tuple[Shape, ...]  # Everything solid; the clearance is measured to them.
    seen: Callable[[float, float], tuple[Shape, ...]]  # What the solver is told of them at a place.
    congestion: Congestion
    steps: int
    style: DrivingStyle = DrivingStyle()

    @property
    def start(self) -> Vector:
        """The state at rest at the track's beginning."""
        return np.array([*self.track.path.points[0], self.start_yaw, 0.0, 0.0, 0.0])


@dataclass(slots=True)
class _Progress:
    """Where on its track a robot is."""

    length: float = 0.0
    turning: bool = False

    def parameters(self, drive: Drive, problem: OptimalControlProblem, state: Vector) -> MpcParameters:
        """Moves on to `state` and gives the parameters of the solve there."""
        track = drive.track
        position = state[[StateIndex.X, StateIndex.Y]]
        self.length, _ = track.progress(position, self.length)
        self.turning = needs_turn(track, float(state[StateIndex.YAW]), self.length, turning=self.turning)
        return make_parameters(
            style=drive.style,
            weights=Preferences().estimate,
            reference=make_reference(
                track, state, self.length, turning=self.turning, horizon=problem.horizon, period=TICK
            ),
            obstacles=drive.seen(float(position[0]), float(position[1])),
            congestion=drive.congestion,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """What one solve was given, and its answer."""

    state: Vector
    parameters: MpcParameters
    warm_start: Vector | None
    solution: Solution


@dataclass
class DriveRun:
    """What one closed loop did. Times are CPU milliseconds of this thread, so other processes do not count."""

    samples: list[Sample] = field(default_factory=list)
    preparation: list[float] = field(default_factory=list)  # Of each solve in two phases.
    feedback: list[float] = field(default_factory=list)  # Of each solve, all of it where there is one phase only.
    cost: float = 0.0  # Sum of the stage costs along the way, against the references of each step.
    min_clearance: float = np.inf  # Metres between body and anything solid.
    position_error: float = np.inf  # Metres between the last state and the goal.

    @property
    def milliseconds(self) -> list[float]:
        """CPU time of each whole solve."""
        if not self.preparation:
            return self.feedback
        return [p + f for p, f in zip(self.preparation, self.feedback, strict=True)]


def run_drive(problem: OptimalControlProblem, solver: Solver, drive: Drive, *, seed: int = 0) -> DriveRun:
    """Drives with one solve a step, as `MpcController` does."""

    def step(state: Vector, parameters: MpcParameters, warm_start: Vector | None) -> tuple[Solution, float]:
        return _timed(lambda: solver.solve(state, parameters, warm_start))

    return _loop(problem, drive, seed, step, lambda *_: None)


def run_drive_in_phases(
    problem: OptimalControlProblem, solver: RealTimeIterationSolver, drive: Drive, *, seed: int = 0
) -> DriveRun:
    """Drives with preparation at the state predicted for the next step, and feedback at the one measured there."""
    preparation: list[float] = []

    def step(state: Vector, parameters: MpcParameters, warm_start: Vector | None) -> tuple[Solution, float]:
        if warm_start is None:
            _, spent = _timed(lambda: solver.prepare(state, parameters))
            preparation.append(spent)
        return _timed(lambda: solver.feedback(state, parameters))

    def prepare(state: Vector, parameters: MpcParameters, warm_start: Vector) -> None:
        _, spent = _timed(lambda: solver.prepare(state, parameters, warm_start))
        preparation.append(spent)

    run = _loop(problem, drive, seed, step, prepare)
    run.preparation = preparation[: len(run.feedback)]  # That of the step after the last is not used.
    return run


def _loop(
    problem: OptimalControlProblem,
    drive: Drive,
    seed: int,
    step: Callable[[Vector, MpcParameters, Vector | None], tuple[Solution, float]],
    prepare: Callable[[Vector, MpcParameters, Vector], None],
) -> DriveRun:
    generator = np.random.default_rng(seed)
    distances = ShapeDistances(drive.shapes)
    run, progress, state, warm_start = DriveRun(), _Progress(), drive.start, None
    for _ in range(drive.steps):
        parameters = progress.parameters(drive, problem, state)
        solution, spent = step(state, parameters, warm_start)
        run.feedback.append(spent)
        run.samples.append(Sample(state, parameters, warm_start, solution))
        run.cost += stage_cost(state, solution.controls[0], parameters.stage)
        warm_start = solution.shifted()
        predicted = problem.step(state, solution.controls[0], parameters.dynamics.vector).full()[:, 0]
        ahead = _Progress(progress.length, progress.turning)
        prepare(predicted, ahead.parameters(drive, problem, predicted), warm_start)
        state = predicted + NOISE * generator.standard_normal(len(NOISE))
        run.min_clearance = min(run.min_clearance, float(distances(state[:2]).min()) - BODY_RADIUS)
    run.position_error = float(np.hypot(*(state[:2] - drive.track.goal)))
    return run


def _timed(call: Callable[[], _Result]) -> tuple[_Result, float]:
    started = time.thread_time()
    result = call()
    return result, 1e3 * (time.thread_time() - started)


def steps_for(track: Track, start_yaw: float) -> int:
    """Control steps in which a drive is over: turning towards the track, along it, and time to settle."""
    turn = abs(float(np.remainder(track.heading(0.0) - start_yaw + np.pi, 2 * np.pi) - np.pi))
    return int((track.path.duration + turn / _TURNING) / TICK) + _SETTLING


_TURNING = 0.7  # Radians per second of a turn on the spot, with its acceleration.
_SETTLING = 30  # Control steps.
