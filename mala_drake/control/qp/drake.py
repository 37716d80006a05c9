"""Drake's solvers for the same quadratic programs, through `MathematicalProgram`: slower, and independent of DAQP."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydrake.solvers import (
    ClarabelSolver,
    MathematicalProgram,
    MathematicalProgramResult,
    OsqpSolver,
    SolutionResult,
    SolverInterface,
    SolverOptions,
)

from .soft_box_qp import QpSolution, QpStatus, SoftBoxQp, failed

Vector = NDArray[np.float64]

_INFEASIBLE = (SolutionResult.kInfeasibleConstraints, SolutionResult.kInfeasibleOrUnbounded)


class DrakeQpSolver(ABC):
    """`QpSolver` with a solver of Drake. A soft row gets a slack variable; the program is built anew each time."""

    name: ClassVar[str]
    solver_type: ClassVar[type[SolverInterface]]
    options: ClassVar[dict[str, Any]]

    def __init__(self) -> None:
        self._solver = self.solver_type()
        self._options = SolverOptions()
        for option, value in self.options.items():
            self._options.SetOption(self._solver.solver_id(), option, value)

    def solve(self, problem: SoftBoxQp, guess: Vector | None = None) -> QpSolution:  # noqa: ARG002
        """See `QpSolver`; the guess is not used, as interior points and splittings have no active set to start from."""
        parts = (problem.hessian, problem.gradient, problem.lower, problem.upper, problem.rows, problem.bounds)
        if not all(np.isfinite(part).all() for part in parts):
            return failed(problem)
        size, rows = problem.gradient.size, problem.bounds.size
        soft = np.flatnonzero(np.isfinite(problem.prices))
        program = MathematicalProgram()
        point = program.NewContinuousVariables(size, "x")
        program.AddQuadraticCost(problem.hessian, problem.gradient, point, is_convex=True)
        box = program.AddBoundingBoxConstraint(problem.lower, problem.upper, point)
        limits, variables, matrix = None, point, problem.rows
        if soft.size:
            slack = program.NewContinuousVariables(soft.size, "slack")
            program.AddQuadraticCost(np.eye(soft.size), np.zeros(soft.size), slack, is_convex=True)
            columns = np.zeros((rows, soft.size))
            columns[soft, np.arange(soft.size)] = -1.0 / np.sqrt(problem.prices[soft])
            variables, matrix = np.concatenate((point, slack)), np.hstack((matrix, columns))
        if rows:
            limits = program.AddLinearConstraint(matrix, np.full(rows, -np.inf), problem.bounds, variables)
        result = self._solver.Solve(program, None, self._options)
        if not result.is_success():
            infeasible = result.get_solution_result() in _INFEASIBLE
            return failed(problem, QpStatus.INFEASIBLE if infeasible else QpStatus.FAILED)
        return QpSolution(
            QpStatus.SOLVED,
            np.clip(result.GetSolution(point), problem.lower, problem.upper),
            # Drake's multiplier is the derivative of the cost with respect to the bound: the opposite sign.
            box_duals=-result.GetDualSolution(box),
            row_duals=np.zeros(0) if limits is None else -result.GetDualSolution(limits),
            iterations=self._iterations(result),
        )

    @abstractmethod
    def _iterations(self, result: MathematicalProgramResult) -> int:
        """How many iterations the solver has taken."""


class ClarabelQpSolver(DrakeQpSolver):
    """Clarabel, an interior-point method (Goulart & Chen, 2024)."""

    name = "clarabel"
    solver_type = ClarabelSolver
    options: ClassVar[dict[str, Any]] = {"tol_gap_abs": 1e-9, "tol_gap_rel": 1e-9, "tol_feas": 1e-9}

    def _iterations(self, result: MathematicalProgramResult) -> int:
        return result.get_solver_details().iterations


class OsqpQpSolver(DrakeQpSolver):
    """OSQP, operator splitting (Stellato et al., Mathematical Programming Computation 12, 2020)."""

    name = "osqp"
    solver_type = OsqpSolver
    options: ClassVar[dict[str, Any]] = {
        "eps_abs": 1e-7,
        "eps_rel": 1e-7,
        "max_iter": 20_000,
        "adaptive_rho_interval": 50,  # By iterations: the default goes by wall time.
    }

    def _iterations(self, result: MathematicalProgramResult) -> int:
        return result.get_solver_details().iter
