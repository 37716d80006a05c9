"""What sensitivities cost and how exact they are: against the control solve and finite differences of the same run.

A leg of the ward is driven in closed loop over the prediction model, N = 20. The rows, in CPU time of this thread:

- control solve, polish: the solve, and the Newton steps from it to the central path.
- policy, primal-dual: their sensitivities at such a point. Conditions, a part of each, also alone.
- differences: central differences of the policy in target and weights, of the solver as it is and of polished solves.
- leg: a closed loop with the policy sensitivities of all its steps, then its forward and adjoint sweep, and central
  differences of the whole leg.

Errors are relative to the largest entry: of differences to the sensitivity, of the adjoint to the forward mode.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mala_drake.control import MakeSolver, MpcParameters, OptimalControlProblem, Solver
from mala_drake.control.sensitivities import (
    ClosedLoop,
    KktPoint,
    SensitivityAnalysis,
    SimulationModel,
    adjoint,
    forward,
)
from mala_drake.control.sensitivities.recorded_leg import KNOBS, NOMINAL, RecordedLeg
from mala_drake.ward.ward_map import LoadWard

from .ward_leg import record_leg

Vector = NDArray[np.float64]

REDUCED = ("terminal", "stage.state_weights", "stage.control_weights")
"""Target and weights: what is learned about an action and from preferences."""

_RELATIVE_STEP = 1e-4  # Of the differences of solutions: of a weight, or of a metre (radian, ...) of the target.
_LEG_STEP = 1e-4  # Of the differences of a leg, in the knobs' units.
_END = np.array([1.0, 1.0, 0.5, 0.1, 0.1, 0.1])  # A gradient at the end of the leg.

SOLVE = "control solve"


@dataclass
class _Table:
    """Times and errors by computation, in the order in which they first occur."""

    milliseconds: dict[str, list[float]] = field(default_factory=dict)
    errors: dict[str, list[float]] = field(default_factory=dict)

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        """Adds the CPU time of its body to computation `name`."""
        started = time.thread_time()
        yield
        self.milliseconds.setdefault(name, []).append(1e3 * (time.thread_time() - started))

    def compare(self, name: str, value: Vector, reference: Vector) -> None:
        """Adds the largest deviation of `value` from `reference`, relative to the largest entry of that."""
        error = np.abs(value - reference).max() / np.abs(reference).max()
        self.errors.setdefault(name, []).append(float(error))

    def rows(self) -> list[dict[str, Any]]:
        """A row a computation: medians, and the time over that of the control solve."""
        solve = float(np.median(self.milliseconds[SOLVE]))
        return [
            {
                "computation": name,
                "count": len(values),
                "median_ms": round(float(np.median(values)), 3),
                "p95_ms": round(float(np.percentile(values, 95)), 3),
                "over_solve": round(float(np.median(values)) / solve, 3),
                "median_error": f"{np.median(self.errors[name]):.1e}" if name in self.errors else "",
            }
            for name, values in self.milliseconds.items()
        ]


def bench_sensitivities(
    *, solver: str = "snopt", start: str = "home", goal: str = "charge_main", every: int = 8
) -> list[dict[str, Any]]:
    """One row a computation, see above.

    Args:
        solver: a name for `MakeSolver`.
        start: place where the leg begins.
        goal: place where it ends.
        every: differences of the policy are taken at each step whose number this divides.
    """
    problem = OptimalControlProblem()
    analysis, mpc = SensitivityAnalysis(problem), MakeSolver(solver, problem)
    leg = record_leg(problem, mpc, LoadWard(), start, goal)
    table = _Table()
    _measure_policy(table, problem, analysis, mpc, leg, every)
    _measure_leg(table, problem, analysis, mpc, leg)
    return table.rows()


def _measure_policy(
    table: _Table,
    problem: OptimalControlProblem,
    analysis: SensitivityAnalysis,
    mpc: Solver,
    leg: RecordedLeg,
    every: int,
) -> None:
    state, warm_start = leg.initial_state, None
    for i, parameters in enumerate(leg.steps):
        with table.timed(SOLVE):
            solution = mpc.solve(state, parameters, warm_start)
        with table.timed("polish"):
            point = analysis.polish(solution, state, parameters)
        with table.timed("policy, all groups"):
            policy = analysis.policy(point)
        with table.timed("policy, target and weights"):
            analysis.policy(point, REDUCED)
        with table.timed("conditions alone"):
            analysis.regularity(point)
        with table.timed("primal-dual, all groups"):
            analysis.primal_dual(point)
        if i % every == 0:
            exact = policy.jacobian[:, analysis.columns.of(REDUCED)]
            for polished in (False, True):
                with table.timed(name := f"differences, {'polished' if polished else 'raw'} solves"):
                    differences = _differences(analysis, mpc, point, polished=polished)
                table.compare(name, differences, exact)
        state = problem.step(state, point.controls[0], parameters.dynamics.vector).full()[:, 0]
        warm_start = solution.shifted()


def _differences(analysis: SensitivityAnalysis, mpc: Solver, point: KktPoint, *, polished: bool) -> Vector:
    """Central differences of the policy in the columns of `REDUCED`, shape (3, 21)."""

    def policy(parameters: MpcParameters) -> Vector:
        solution = mpc.solve(point.initial_state, parameters, point.controls)
        if not polished:
            return solution.controls[0]
        return analysis.polish(solution, point.initial_state, parameters).controls[0]

    columns = []
    for group, name in (
        ("terminal", "target"),
        ("terminal", "weights"),
        ("stage", "state_weights"),
        ("stage", "control_weights"),
    ):
        values = getattr(getattr(point.parameters, group), name)
        for entry in range(len(values)):
            size = _RELATIVE_STEP * (1.0 if name == "target" else values[entry])
            ends = []
            for sign in (1, -1):
                moved = values.copy()
                moved[entry] += sign * size
                changed = replace(getattr(point.parameters, group), **{name: moved})
                ends.append(policy(replace(point.parameters, **{group: changed})))
            columns.append((ends[0] - ends[1]) / (2 * size))
    return np.array(columns).T


def _measure_leg(
    table: _Table, problem: OptimalControlProblem, analysis: SensitivityAnalysis, mpc: Solver, leg: RecordedLeg
) -> None:
    loop = ClosedLoop(analysis, mpc, SimulationModel(period=problem.period))
    model, count = leg.steps[0].dynamics.vector, len(leg.steps)

    def run(knobs: Vector) -> Any:
        return loop.run(leg.initial_state, leg.with_knobs(knobs, analysis.columns), model, count)

    with table.timed(f"leg of {count} steps"):
        nominal = run(np.array(NOMINAL))
    with table.timed("leg, forward"):
        whole = forward(nominal)
    with table.timed(name := "leg, adjoint"):
        gradient = adjoint(nominal, _END)
    by_end = _END @ whole.by_knobs.states[-1]
    table.compare(name, gradient.by_knobs, by_end)
    with table.timed(name := f"leg, differences in {len(KNOBS)} knobs"):
        steps = _LEG_STEP * np.eye(len(KNOBS))
        ends = [[_END @ run(np.array(NOMINAL) + sign * step).states[-1] for step in steps] for sign in (1, -1)]
    table.compare(name, (np.array(ends[0]) - np.array(ends[1])) / (2 * _LEG_STEP), by_end)
