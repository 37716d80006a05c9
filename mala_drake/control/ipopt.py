"""IPOPT, the cross-check: an interior-point method that shares nothing with SNOPT but the problem."""

from __future__ import annotations

from typing import Any

from pydrake.solvers import IpoptSolver

from .mathematical_program_solver import MathematicalProgramSolver

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
