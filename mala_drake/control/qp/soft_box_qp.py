"""The quadratic program of one Gauss-Newton step: a box, and rows that may be exceeded at a price.

minimise   x' H x / 2 + f' x + sum_i c_i max(0, a_i' x - b_i)^2 / 2   over x
subject to l <= x <= u, and a_i' x <= b_i for the rows whose price c_i is infinite

The rows are what the smoothed exact penalties of the optimal control problem become when their margins are linear.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class SoftBoxQp:
    """A problem with n variables and m rows."""

    hessian: Vector  # H, shape (n, n), positive definite.
    transform: Vector  # T, shape (n, n), with T' H T = I; see `whitening`.
    gradient: Vector  # f, shape (n,).
    lower: Vector  # l, shape (n,).
    upper: Vector  # u, shape (n,).
    rows: Vector  # a_i, shape (m, n).
    bounds: Vector  # b, shape (m,).
    prices: Vector  # c > 0, shape (m,); infinite for a hard row.

    def objective(self, point: Vector) -> float:
        """The value at `point`, shape (n,), the hard rows left out."""
        soft = np.isfinite(self.prices)
        excess = np.maximum(self.rows[soft] @ point - self.bounds[soft], 0.0)
        quadratic = 0.5 * point @ (self.hessian @ point) + self.gradient @ point
        return float(quadratic + 0.5 * excess @ (self.prices[soft] * excess))


class QpStatus(StrEnum):
    """How a solve ended."""

    SOLVED = "solved"
    INFEASIBLE = "infeasible"  # The hard rows contradict the box or each other.
    FAILED = "failed"  # Iteration limit, numerical trouble, or data that are not finite.


@dataclass(frozen=True, slots=True, eq=False)
class QpSolution:
    """The minimiser with its multipliers; stationarity reads H x + f + box_duals + rows' row_duals = 0."""

    status: QpStatus
    point: Vector  # x, shape (n,).
    box_duals: Vector  # Shape (n,): >= 0 at an active upper, <= 0 at an active lower bound.
    row_duals: Vector  # Shape (m,), >= 0; c_i max(0, a_i' x - b_i) where the row is soft.
    iterations: int


def failed(problem: SoftBoxQp, status: QpStatus = QpStatus.FAILED, iterations: int = 0) -> QpSolution:
    """The answer when there is no minimiser to return: the box's point nearest to zero, no multipliers."""
    point = np.clip(np.zeros_like(problem.gradient), problem.lower, problem.upper)
    return QpSolution(status, point, np.zeros_like(point), np.zeros_like(problem.bounds), iterations)


class QpSolver(Protocol):
    """The contract of every QP solver. One instance serves one user: it may own work arrays."""

    name: str

    def solve(self, problem: SoftBoxQp, guess: Vector | None = None) -> QpSolution:
        """Minimises.

        Args:
            problem: what to minimise.
            guess: of the multipliers, box then rows, shape (n + m,); only its signs count, as a first active set.
                It changes the way to the solution, never the solution.
        """
        ...
