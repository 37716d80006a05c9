"""Whether the MPC solvers agree on the states that closed loops visit; see `solver_agreement.py`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from mala_drake.control import MakeSolver, OptimalControlProblem, Solver

from .model_drive import Sample, run_drive
from .model_drives import course, hard_legs
from .solver_agreement import Verdict, compare

_TIGHT = 1e-5  # Tolerance at which the problem itself is compared rather than where a solver chooses to stop.
_PATIENCE = 500  # Iterations, more than a solve ever needs.


def bench_agreement() -> list[dict[str, Any]]:
    """A row a solver and tolerance: how its answers compare with SNOPT's at the same tolerance.

    The samples are those of closed loops with SNOPT: each step on the course, every third on the ward's hard legs;
    IPOPT, which takes long, is given every eighth of them.
    """
    problem = OptimalControlProblem()
    samples = visited(problem)
    rows = []
    for tolerance in (1e-4, _TIGHT):
        for name, every in (("rti", 1), ("ipopt", 8)):
            other = precise(name, problem, tolerance)
            rows.append(agreement(precise("snopt", problem, tolerance), other, samples[::every], tolerance))
    return rows


def precise(name: str, problem: OptimalControlProblem, tolerance: float = _TIGHT) -> Solver:
    """A solver that iterates until it is there."""
    limit = "sqp_iterations" if name == "rti" else "iteration_limit"
    return MakeSolver(name, problem, tolerance=tolerance, **{limit: _PATIENCE})


def visited(problem: OptimalControlProblem) -> list[Sample]:
    """The samples of closed loops with SNOPT."""
    solver = MakeSolver("snopt", problem)
    samples = run_drive(problem, solver, course()).samples
    for drive in hard_legs():
        samples += run_drive(problem, solver, drive).samples[::3]
    return samples


def agreement(reference: Solver, other: Solver, samples: Sequence[Sample], tolerance: float) -> dict[str, Any]:
    """How often each verdict was given, and the largest difference between costs that count as the same."""
    comparisons = compare(reference, other, samples)
    counts = Counter(comparison.verdict for comparison in comparisons)
    same = [abs(c.difference) for c in comparisons if c.verdict is Verdict.SAME]
    return {
        "reference": reference.name,
        "solver": other.name,
        "tolerance": tolerance,
        "samples": len(samples),
        **{verdict.value: counts[verdict] for verdict in Verdict},
        "largest_difference_of_same": float(f"{max(same, default=np.nan):.1e}"),
    }
