"""DAQP: a dual active-set method, the fastest for these small dense problems."""

from __future__ import annotations

import daqp
import numpy as np
from numpy.typing import NDArray

from .soft_box_qp import QpSolution, QpStatus, SoftBoxQp, failed

Vector = NDArray[np.float64]

_SOLVED = 1
_INFEASIBLE = -1
_NO_BOUND = 1e30  # What DAQP takes for infinite.
_ITERATION_LIMIT = 2000


class DaqpSolver:
    """`QpSolver` with DAQP (Arnstrom, Bemporad, Axehill, IEEE Transactions on Automatic Control 67, 2022).

    It is given the problem in the variables x = T y, in which the Hessian is the identity, so that its own set-up is
    next to nothing. A soft row gets a slack variable of unit curvature: DAQP's own soft constraints share one weight.
    """

    name = "daqp"

    def __init__(self) -> None:
        self._model = daqp.Model()

    def solve(self, problem: SoftBoxQp, guess: Vector | None = None) -> QpSolution:
        """See `QpSolver`."""
        variables, rows = problem.gradient.size, problem.bounds.size
        soft = np.flatnonzero(np.isfinite(problem.prices))
        size = variables + soft.size
        matrix = np.zeros((variables + rows, size))
        matrix[:variables, :variables] = problem.transform
        matrix[variables:, :variables] = problem.rows @ problem.transform
        matrix[variables + soft, variables + np.arange(soft.size)] = -1.0 / np.sqrt(problem.prices[soft])
        gradient = np.zeros(size)
        gradient[:variables] = problem.gradient @ problem.transform
        upper = np.concatenate((problem.upper, problem.bounds))
        lower = np.concatenate((problem.lower, np.full(rows, -_NO_BOUND)))
        if not all(np.isfinite(part).all() for part in (matrix, gradient, upper, lower)):
            return failed(problem)
        sense = np.zeros(variables + rows, dtype=np.int32)
        flag, _ = self._model.setup(np.eye(size), gradient, matrix, upper, lower, sense, dual_start=guess)
        if flag < 0:
            return failed(problem, QpStatus.INFEASIBLE if flag == _INFEASIBLE else QpStatus.FAILED)
        self._model.settings = {"iter_limit": _ITERATION_LIMIT}
        point, _, flag, info = self._model.solve()
        duals = info["lam"]
        if flag != _SOLVED or not (np.isfinite(point).all() and np.isfinite(duals).all()):
            status = QpStatus.INFEASIBLE if flag == _INFEASIBLE else QpStatus.FAILED
            return failed(problem, status, info["iterations"])
        box_duals = duals[:variables]
        x = np.clip(problem.transform @ point[:variables], problem.lower, problem.upper)
        # An active bound is met to the solver's tolerance only, while the active set is read off the point later.
        x = np.where(box_duals > 0.0, problem.upper, np.where(box_duals < 0.0, problem.lower, x))
        return QpSolution(QpStatus.SOLVED, x, box_duals, duals[variables:], info["iterations"])
