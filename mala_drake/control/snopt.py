"""SNOPT, the reference: sequential quadratic programming with a quasi-Newton Hessian."""

from __future__ import annotations

from typing import Any

from pydrake.solvers import SnoptSolver

from .mathematical_program_solver import MathematicalProgramSolver


class SnoptShootingSolver(MathematicalProgramSolver):
    """`MathematicalProgramSolver` with SNOPT (Gill, Murray, Saunders, SIAM Review 47, 2005)."""

    name = "snopt"
    round_length = 200

    def _make_solver(self) -> SnoptSolver:
        return SnoptSolver()

    def _make_options(self, tolerance: float, iteration_limit: int) -> dict[str, Any]:
        return {
            "Major optimality tolerance": tolerance,
            "Major iterations limit": iteration_limit,
            "Iterations limit": 100 * iteration_limit,
            "Function precision": 1e-13,
            "Linesearch tolerance": 0.9,
        }
