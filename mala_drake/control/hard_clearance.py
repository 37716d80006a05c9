"""Clearance as a hard constraint wherever that is proven feasible.

The penalty of `shooting.py` is exact only while its slope exceeds the multiplier. This adds, for each stage, the
constraint margin(nearest obstacle) >= 0 that no pull can overcome. It is switched on at those stages where the starting
point of the solve satisfies it: that point is then admissible, so the constrained problem is never infeasible.
"""

from __future__ import annotations

from operator import methodcaller
from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray
from pydrake.autodiffutils import InitializeAutoDiff
from pydrake.solvers import MathematicalProgram, MathematicalProgramResult

from mala_drake.buffered_function import BufferedFunction, densified

from .optimal_control_problem import OptimalControlProblem

Vector = NDArray[np.float64]

_value = methodcaller("value")


class HardClearance:
    """N nonlinear constraints of a `MathematicalProgram` over w, with U = U_0 + T w."""

    def __init__(self, problem: OptimalControlProblem, program: MathematicalProgram, variables: NDArray[Any]) -> None:
        self._function = BufferedFunction(_selected_margins(problem))
        self._point = self._function.arguments[0].reshape(-1, order="F")
        self._stages = np.arange(problem.horizon)
        self._nearest = np.zeros(problem.horizon, dtype=int)
        self._slots = problem.layout.slots
        self._origin, self._transform = np.zeros(len(variables)), np.eye(len(variables))
        self.failure: Exception | None = None
        free = np.full(problem.horizon, -np.inf)
        self._binding = program.AddConstraint(self._evaluate, free, -free, variables)

    def update(self, initial_state: Vector, packed: Vector, origin: Vector, transform: Vector, margins: Vector) -> None:
        """Chooses the obstacle of each stage and switches its constraint.

        Args:
            initial_state: z_0, shape (6,).
            packed: p.
            origin: U_0, shape (3 N,).
            transform: T, shape (3 N, 3 N).
            margins: obstacle margins along U_0, shape (N, M).
        """
        self.failure = None
        self._nearest = margins.argmin(axis=1)
        selection = np.zeros_like(margins)
        selection[self._stages, self._nearest] = 1.0
        for argument, value in zip(self._function.arguments[1:], (initial_state, packed), strict=False):
            argument[:, 0] = value
        self._function.arguments[3][:] = selection.T
        self._origin, self._transform = origin, transform
        holds = margins[self._stages, self._nearest] >= 0
        self._binding.evaluator().UpdateLowerBound(np.where(holds, 0.0, -np.inf))

    def duals(self, result: MathematicalProgramResult) -> Vector:
        """Multipliers (>= 0) by stage and obstacle slot, shape (N, M)."""
        duals = np.zeros((len(self._stages), self._slots))
        duals[self._stages, self._nearest] = result.GetDualSolution(self._binding)
        return duals

    def _evaluate(self, variables: NDArray[Any]) -> NDArray[Any]:
        """The margins, with their Jacobian with respect to w where asked for; see `ShootingProgram._evaluate`."""
        plain = variables.dtype == float
        margins, jacobian = np.zeros((len(self._stages), 1)), np.zeros((len(self._stages), len(variables)))
        try:
            offset = variables if plain else np.fromiter(map(_value, variables), float, len(variables))
            self._point[:] = self._origin + self._transform @ offset
            self._function()
            values, slopes = self._function.results
            if np.isfinite(values).all() and np.isfinite(slopes).all():
                margins, jacobian = values.copy(), slopes @ self._transform
            else:
                self.failure = ArithmeticError("a margin or its gradient is not finite")
        except Exception as error:
            self.failure = error
        return margins[:, 0] if plain else InitializeAutoDiff(margins, jacobian)[:, 0]


def _selected_margins(problem: OptimalControlProblem) -> casadi.Function:
    """(U, z_0, p, selection) -> (margins, shape (N, 1), their Jacobian, shape (N, 3 N))."""
    expressions = problem.expressions
    selection = casadi.SX.sym("selection", problem.layout.slots, problem.horizon)
    margins = casadi.sum1(selection * expressions.obstacle_margins).T
    inputs = [expressions.controls, expressions.initial_state, expressions.parameters, selection]
    return densified("selected_margins", inputs, [margins, casadi.jacobian(margins, casadi.vec(expressions.controls))])
