"""How fast the MPC solves, and how well it drives: closed loops over the prediction model on an obstacle course.

The course fills all eight obstacle slots. The reference comes from a route round seven of them; the eighth stands at
its edge and only the solver avoids it. Noise on the state stands for everything that the model does not know.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mala_drake.clock import TICK
from mala_drake.control import (
    ConstraintParameters,
    MakeSolver,
    MpcParameters,
    OptimalControlProblem,
    Solver,
    StageParameters,
    TerminalParameters,
)
from mala_drake.control.model import StateIndex
from mala_drake.control.reference import Track, make_reference, needs_turn
from mala_drake.messages import Shape
from mala_drake.ward.congestion import CRUISE_SPEED, Congestion
from mala_drake.ward.drive_path import make_drive_path
from mala_drake.ward.routes import BODY_RADIUS, RoutePlanner
from mala_drake.ward.shapes import ShapeDistances
from mala_drake.ward.ward_map import Ward

Vector = NDArray[np.float64]

MAPPED = (
    Shape("cabinet", 3.0, 0.2, 0.3, half_length=0.45, half_width=0.35, radius=0.05),
    Shape("partition", 5.0, -1.6, 0.0, half_length=0.1, half_width=1.2),
    Shape("pillar", 6.6, 0.9, radius=0.4),
    Shape("trolley", 4.4, 1.9, 0.4, half_length=0.5, half_width=0.3, radius=0.02),
    Shape("bed", 9.0, -0.9, -0.5, half_length=1.1, half_width=0.5, radius=0.1),
    Shape("desk", 8.6, 2.3, 0.1, half_length=0.7, half_width=0.4),
    Shape("wall", 5.0, 3.4, 0.0, half_length=6.0, half_width=0.1),
)
UNMAPPED = Shape("bucket", 1.6, -0.85, radius=0.18)
START, GOAL = (0.0, 0.0), (11.0, 0.6, 0.4)

_NOISE = np.array([0.004, 0.004, 0.004, 0.02, 0.0, 0.02])  # Standard deviations of the state, per step.
_EMPTY_WARD = Ward("course", 50.0, 0.2, 2.0, (), (), (), 0.02)


@dataclass
class CourseRun:
    """What one closed loop did."""

    milliseconds: list[float] = field(default_factory=list)  # Wall time of each solve.
    cpu_milliseconds: list[float] = field(default_factory=list)  # The same without what other processes took.
    evaluations: list[int] = field(default_factory=list)  # Of cost and gradient, per solve.
    cost: float = 0.0  # Sum of the stage costs along the way, against the references of each step.
    min_clearance: float = np.inf  # Metres between body and obstacles, the unmapped one included.
    failures: int = 0  # Solves that ended without a local optimum.
    states: list[Vector] = field(default_factory=list)

    @property
    def position_error(self) -> float:
        """Metres between the last state and the goal."""
        return float(np.hypot(*(self.states[-1][:2] - GOAL[:2])))


def bench_mpc(
    solvers: Sequence[str] = ("snopt", "ipopt"), *, steps: int = 90, seeds: Sequence[int] = (0, 1, 2)
) -> list[dict[str, float | str]]:
    """Drives the course with each solver and seed; a row a solver.

    Args:
        solvers: names for `MakeSolver`.
        steps: control steps a run.
        seeds: of the noise, one run each.
    """
    problem = OptimalControlProblem()
    rows: list[dict[str, float | str]] = []
    for name in solvers:
        solver = MakeSolver(name, problem)
        runs = [drive_course(problem, solver, steps=steps, seed=seed) for seed in seeds]
        rows.append({"solver": name, **_summary(runs)})
    return rows


def drive_course(problem: OptimalControlProblem, solver: Solver, *, steps: int, seed: int) -> CourseRun:
    """One closed loop over the model."""
    generator = np.random.default_rng(seed)
    distances = ShapeDistances((*MAPPED, UNMAPPED))
    run = CourseRun()
    state, warm_start = np.array([*START, 0.0, 0.0, 0.0, 0.0]), None
    for parameters in _course_parameters(run, problem, steps):
        started, cpu_started = time.perf_counter(), time.thread_time()
        solution = solver.solve(state, parameters, warm_start)
        run.milliseconds.append(1e3 * (time.perf_counter() - started))
        run.cpu_milliseconds.append(1e3 * (time.thread_time() - cpu_started))
        run.evaluations.append(solution.iterations)
        run.failures += not solution.success
        run.cost += _stage_cost(state, solution.controls[0], parameters.stage)
        warm_start = solution.shifted()
        next_state = problem.step(state, solution.controls[0], parameters.dynamics.vector)
        state = next_state.full()[:, 0] + _NOISE * generator.standard_normal(len(_NOISE))
        run.states.append(state)
        run.min_clearance = min(run.min_clearance, float(distances(state[:2]).min()) - BODY_RADIUS)
    return run


def _course_parameters(run: CourseRun, problem: OptimalControlProblem, steps: int) -> Iterator[MpcParameters]:
    """The parameters of each step, for the state that `run` has reached."""
    route = RoutePlanner(MAPPED).route(START, GOAL[:2])
    if route is None:
        raise AssertionError("the course has a route by construction")
    track = Track(make_drive_path(route, Congestion(_EMPTY_WARD)), GOAL[2])
    length, turning = 0.0, False
    for _ in range(steps):
        state = run.states[-1] if run.states else np.array([*START, 0.0, 0.0, 0.0, 0.0])
        length, _distance = track.progress(state[[StateIndex.X, StateIndex.Y]], length)
        turning = needs_turn(track, float(state[StateIndex.YAW]), length, turning=turning)
        states = make_reference(track, state, length, turning=turning, horizon=problem.horizon, period=TICK).states
        yield MpcParameters(
            TerminalParameters(states[-1]),
            StageParameters(states[:-1]),
            ConstraintParameters(np.full(problem.horizon, CRUISE_SPEED), obstacles=(*MAPPED, UNMAPPED)),
        )


def _stage_cost(state: Vector, control: Vector, stage: StageParameters) -> float:
    error = state - stage.references[0]
    error[StateIndex.YAW] = np.remainder(error[StateIndex.YAW] + np.pi, 2 * np.pi) - np.pi
    return float(error**2 @ stage.state_weights + control**2 @ stage.control_weights)


def _summary(runs: Sequence[CourseRun]) -> dict[str, float | str]:
    milliseconds = np.concatenate([run.milliseconds for run in runs])
    evaluations = np.concatenate([run.evaluations for run in runs])
    return {
        "solves": len(milliseconds),
        "median_ms": round(float(np.median(milliseconds)), 2),
        "p95_ms": round(float(np.percentile(milliseconds, 95)), 2),
        "max_ms": round(float(milliseconds.max()), 2),
        "median_cpu_ms": round(float(np.median(np.concatenate([run.cpu_milliseconds for run in runs]))), 2),
        "median_evaluations": float(np.median(evaluations)),
        "cost": round(float(np.mean([run.cost for run in runs])), 2),
        "min_clearance_m": round(min(run.min_clearance for run in runs), 3),
        "position_error_m": round(max(run.position_error for run in runs), 3),
        "failures": sum(run.failures for run in runs),
    }
