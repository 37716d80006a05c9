"""IPOPT, the cross-check: an interior-point method that shares nothing with SNOPT but the problem."""

from __future__ import annotations

from typing import Any

from pydrake.solvers import IpoptSolver, MathematicalProgramResult

from .mathematical_program_solver import MathematicalProgramSolver

_ITERATION_LIMIT_CODE = -1  # Ipopt's Maximum_Iterations_Exceeded.
_TIGHTER = 0.01  # Complementarity within tol leaves bounds that should be active a root of it away.


class IpoptShootingSolver(MathematicalProgramSolver):
    """`MathematicalProgramSolver` with IPOPT (Waechter, Biegler, Mathematical Programming 106, 2006).

    The Hessian is a limited-memory approximation: Drake gives IPOPT no second derivatives.
    """

    name = "ipopt"
    round_length = 40

    def _make_solver(self) -> IpoptSolver:
        return IpoptSolver()

    def _make_options(self, tolerance: float, iteration_limit: int) -> dict[str, Any]:
        return {
            "tol": _TIGHTER * tolerance,
            "max_iter": iteration_limit,
            "hessian_approximation": "limited-memory",
            "limited_memory_max_history": 30,
            "mu_strategy": "adaptive",
            "print_level": 0,
        }

    def _hit_iteration_limit(self, result: MathematicalProgramResult) -> bool:
        return result.get_solver_details().status == _ITERATION_LIMIT_CODE
