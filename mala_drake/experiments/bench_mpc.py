"""How fast the MPC solves, and how well it drives: closed loops over the prediction model, every solver the same ones.

Two sets of drives: an obstacle course with three seeds of noise, and the hard legs of the ward. Times are CPU times of
the solving thread, as other processes do not count in them; read them as ratios within one run.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from mala_drake.control import MakeSolver, OptimalControlProblem
from mala_drake.control.rti import RealTimeIterationSolver

from .model_drive import Drive, DriveRun, run_drive, run_drive_in_phases
from .model_drives import course, hard_legs


def bench_mpc() -> list[dict[str, Any]]:
    """A row a set of drives and solver: time by phase, evaluations, closed-loop cost, clearance and failures.

    The cost of a set is compared with that of SNOPT, its first row. `rti` is driven with one, two and three iterations
    in two phases, and in one phase to convergence. IPOPT, which takes long, drives the course only.
    """
    problem = OptimalControlProblem()
    rows = bench_drives(problem, "course", [course()], (0, 1, 2), drakes=("snopt", "ipopt"))
    return rows + bench_drives(problem, "ward", hard_legs(), (0, 1))


def bench_drives(
    problem: OptimalControlProblem,
    name: str,
    drives: Sequence[Drive],
    seeds: Sequence[int],
    *,
    drakes: Sequence[str] = ("snopt",),
    iterations: Sequence[int] = (1, 2, 3, 20),
) -> list[dict[str, Any]]:
    """Rows of one set of drives.

    Args:
        problem: what is solved.
        name: of the set.
        drives: each is driven once a seed.
        seeds: of the noise.
        drakes: solvers of Drake; cost is compared with the first one's.
        iterations: of `rti`; those above three are driven in one phase.
    """
    rows: list[dict[str, Any]] = []
    for solver_name in drakes:
        solver = MakeSolver(solver_name, problem)
        runs = [run_drive(problem, solver, drive, seed=seed) for drive in drives for seed in seeds]
        rows.append({"drives": name, "solver": solver_name, **_summary(runs)})
    for count in iterations:
        rti = RealTimeIterationSolver(problem, sqp_iterations=count)
        drive_with = run_drive_in_phases if count <= 3 else run_drive
        runs = [drive_with(problem, rti, drive, seed=seed) for drive in drives for seed in seeds]
        rows.append({"drives": name, "solver": f"rti, {count}", **_summary(runs)})
    for row in rows:
        row["cost_ratio"] = round(row["cost"] / rows[0]["cost"], 4)
    return rows


def _summary(runs: Sequence[DriveRun]) -> dict[str, Any]:
    milliseconds = np.concatenate([run.milliseconds for run in runs])
    feedback = np.concatenate([run.feedback for run in runs])
    preparation = np.concatenate([run.preparation for run in runs])
    solutions = [sample.solution for run in runs for sample in run.samples]
    return {
        "solves": len(milliseconds),
        "median_ms": round(float(np.median(milliseconds)), 2),
        "p95_ms": round(float(np.percentile(milliseconds, 95)), 2),
        "max_ms": round(float(milliseconds.max()), 2),
        "preparation_ms": round(float(np.median(preparation)), 2) if len(preparation) else 0.0,
        "feedback_ms": round(float(np.median(feedback)), 2),
        "feedback_p95_ms": round(float(np.percentile(feedback, 95)), 2),
        "evaluations": float(np.median([solution.iterations for solution in solutions])),
        "cost": round(float(sum(run.cost for run in runs)), 2),
        "min_clearance_m": round(min(run.min_clearance for run in runs), 3),
        "position_error_m": round(max(run.position_error for run in runs), 3),
        "not_converged": sum(solution.usable and not solution.success for solution in solutions),
        "failures": sum(not solution.usable for solution in solutions),
    }
