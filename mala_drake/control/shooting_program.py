"""The shooting problem as a `MathematicalProgram`, built once and evaluated through CasADi."""

from __future__ import annotations

from dataclasses import dataclass
from operator import methodcaller
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.autodiffutils import AutoDiffXd
from pydrake.solvers import MathematicalProgram, MathematicalProgramResult, SolverInterface, SolverOptions

from mala_drake.buffered_function import BufferedFunction

from .condensing import whitening
from .hard_clearance import HardClearance
from .model import CONTROL_SIZE
from .optimal_control_problem import OptimalControlProblem
from .parameters import InputParameters

Vector = NDArray[np.float64]

_UNUSABLE = 1e10  # A finite value that no line search accepts, for points where the cost does not exist.
_value = methodcaller("value")


@dataclass(frozen=True, slots=True)
class Run:
    """What a run of a solver gave."""

    result: MathematicalProgramResult
    controls: Vector  # Shape (N, 3), inside the input set.
    control_duals: Vector  # Multipliers of the input set, shape (N, 3).
    clearance_duals: Vector | float  # Multipliers of hard clearance, shape (N, M), or 0 without it.


class ShootingProgram:
    """Minimises scale * cost(U_0 + T w) over w subject to the input set.

    Quasi-Newton methods start from the identity as Hessian, while the condition number of the shooting problem is about
    1e5. With T T' the inverse of a Gauss-Newton Hessian at U_0 the identity is a good guess, and a solve takes a fifth
    of the evaluations; the price is that the box becomes 3 N linear rows. T, the bounds and the parameters change by
    value between runs.
    """

    def __init__(self, problem: OptimalControlProblem, *, hard_clearance: bool = False) -> None:
        self._function = BufferedFunction(problem.cost_and_gradient)
        self._point = self._function.arguments[0].reshape(-1, order="F")
        self._gradient = self._function.results[1].reshape(-1, order="F")
        self._horizon = problem.horizon
        size = CONTROL_SIZE * problem.horizon
        self._origin, self._transform, self._scale = np.zeros(size), np.eye(size), 1.0
        self._program = MathematicalProgram()
        self._variables = self._program.NewContinuousVariables(size, "w")
        self._program.AddCost(self._evaluate, self._variables)
        self._box = self._program.AddLinearConstraint(np.eye(size), np.zeros(size), np.zeros(size), self._variables)
        self._clearance = HardClearance(problem, self._program, self._variables) if hard_clearance else None
        self._failure: Exception | None = None
        self.evaluations = 0

    @property
    def failure(self) -> Exception | None:
        """What went wrong in a callback of the last run, if anything did."""
        return self._failure or (self._clearance.failure if self._clearance is not None else None)

    def set_parameters(self, initial_state: Vector, packed: Vector) -> None:
        """Chooses z_0, shape (6,), and p for the evaluations to come."""
        self._function.arguments[1][:, 0] = initial_state
        self._function.arguments[2][:, 0] = packed

    def run(
        self,
        solver: SolverInterface,
        options: SolverOptions,
        *,
        origin: Vector,
        hessian: Vector,
        scale: float,
        inputs: InputParameters,
        margins: Vector,
    ) -> Run:
        """Runs `solver` from the controls `origin`, shape (N, 3).

        Args:
            solver: a solver of smooth costs with linear constraints.
            options: its options.
            origin: where to start.
            hessian: a positive definite model of the cost's Hessian there, shape (3 N, 3 N).
            scale: factor on the cost, in which the solver's tolerance is measured.
            inputs: p^a.
            margins: obstacle margins along `origin`, shape (N, M).
        """
        self._failure, self.evaluations, self._scale = None, 0, scale
        self._origin = origin.ravel().copy()
        # Drake ends the process over a constraint with entries that are not finite: `whitening` lets none get there.
        self._transform = whitening(scale * hessian)
        lower, upper = (np.tile(bound, self._horizon) - self._origin for bound in (inputs.lower, inputs.upper))
        self._box.evaluator().UpdateCoefficients(self._transform, lower, upper)
        if self._clearance is not None:
            state, packed = (self._function.arguments[i][:, 0] for i in (1, 2))
            self._clearance.update(state, packed, self._origin, self._transform, margins)
        result = solver.Solve(self._program, np.zeros(origin.size), options)
        controls = (self._origin + self._transform @ result.GetSolution(self._variables)).reshape(origin.shape)
        return Run(
            result,
            controls=np.clip(controls, inputs.lower, inputs.upper),
            control_duals=result.GetDualSolution(self._box).reshape(origin.shape) / scale,
            clearance_duals=0.0 if self._clearance is None else self._clearance.duals(result) / scale,
        )

    def _evaluate(self, variables: NDArray[Any]) -> AutoDiffXd:
        """The scaled cost at Drake's AutoDiff point.

        The cost is bound to all variables in order, so the derivatives of the argument are the identity and the
        gradient is the derivative as it stands. An exception here could make a solver run on: it is kept, and told.
        """
        try:
            self.evaluations += 1
            offset = np.fromiter(map(_value, variables), float, len(variables))
            self._point[:] = self._origin + self._transform @ offset
            self._function()
            cost = float(self._function.results[0][0, 0]) * self._scale
            gradient = (self._gradient * self._scale) @ self._transform
            if np.isfinite(cost) and np.isfinite(gradient).all():
                return AutoDiffXd(cost, gradient)
            self._failure = ArithmeticError("cost or gradient is not finite")
        except Exception as error:
            self._failure = error
        return AutoDiffXd(_UNUSABLE, np.zeros(len(variables)))
