"""V_theta, Q_theta and pi_theta from one optimal control problem (paper, eq. MPC:Pi and MPC:Q).

Q_theta(s, a) is the problem with u_0 = a as one more constraint: V_theta(s) = min_a Q_theta(s, a), attained by
pi_theta(s). Both are found by local search: with several ways round an obstacle they are those of the way found, and a
Q below V tells that V's solver took the longer one. Gradients follow from the envelope theorem: they are the partial
derivatives of the Lagrange function, with the multipliers of the solution, and need no sensitivity of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.buffered_function import BufferedFunction
from mala_drake.control.initial_guess import InitialGuesses
from mala_drake.control.model import STATE_SIZE
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.parameters import MpcParameters
from mala_drake.control.solver import Solver
from mala_drake.errors import BadInput
from mala_drake.messages import Message

from .columns import INITIAL_STATE, LOWER, UPPER, Columns
from .interior_point import BARRIER, InteriorPoint
from .kkt_point import KktPoint

Vector = NDArray[np.float64]

_PATH = (1e-2,)
"""Barriers gone through on the way to Q's solution, whose start is no solution."""


@dataclass(frozen=True, slots=True, eq=False)
class Value(Message):
    """A value of V or Q with its gradients."""

    value: float  # The optimal cost; above the exact one by at most nu a bound.
    gradient: Vector  # With respect to (p, z_0), in the order of `Columns`.
    action: Vector  # pi(s) for V, a for Q; shape (3,).
    action_gradient: Vector  # d Q / d a, shape (3,); for V that of Q at pi(s), zero but where a bound is active.
    converged: bool
    point: KktPoint


class ValueFunctions:
    """V and Q of one problem. Owns work arrays."""

    def __init__(self, problem: OptimalControlProblem, solver: Solver, *, barrier: float = BARRIER) -> None:
        """Prepares the functions.

        Args:
            problem: the problem, which is only read.
            solver: of this problem.
            barrier: nu, in units of the cost.
        """
        self.columns = Columns(problem.layout)
        self._problem = problem
        self._solver = solver
        self._guesses = InitialGuesses(problem)
        self._interior_point = InteriorPoint(problem, barrier=barrier)
        self._gradient = BufferedFunction(self._interior_point.functions.parameter_gradient)

    def value(self, state: ArrayLike, parameters: MpcParameters, warm_start: ArrayLike | None = None) -> Value:
        """V(s) and, as its action, pi(s), for s of shape (6,)."""
        solution = self._solver.solve(state, parameters, warm_start)
        point = self._interior_point.polish(solution.controls, state, parameters, duals=solution.control_duals)
        return self._report(point)

    def action_value(
        self, state: ArrayLike, action: ArrayLike, parameters: MpcParameters, warm_start: ArrayLike | None = None
    ) -> Value:
        """Q(s, a) for s of shape (6,) and a of shape (3,).

        Args:
            state: s.
            action: a, in the input set.
            parameters: of the problem.
            warm_start: controls, shape (N, 3), of which all but the first are a start; V's are a good one.

        Raises:
            BadInput: the action is outside of the input set, where Q is infinite.
        """
        first, z = np.array(action, dtype=float), np.array(state, dtype=float)
        lower, upper = parameters.inputs.lower, parameters.inputs.upper
        if first.shape != lower.shape or not ((lower <= first) & (first <= upper)).all():
            raise BadInput("action", str(action), f"three numbers from {lower} to {upper}")
        packed = self._problem.pack(z, parameters)
        self._interior_point.sweeps.set_parameters(z, packed)
        starts = self._guesses(z, parameters, warm_start)
        for start in starts:
            start[0] = first
        costs = [self._interior_point.sweeps.forward(start)[1] for start in starts]
        best = starts[int(np.argmin(costs))]
        return self._report(self._interior_point.polish(best, z, parameters, first_control=first, barriers=_PATH))

    def _report(self, point: KktPoint) -> Value:
        columns, slices = self.columns, self.columns.slices
        gradient = np.zeros(columns.size)
        data = self._interior_point.functions.data
        rows = (point.controls, point.states[1:], point.costates[1:], point.states[:-1], point.packed[data.sources])
        for argument, value in zip(self._gradient.arguments, rows, strict=True):
            argument[:] = value.T
        self._gradient()
        places, entries = data.sources.ravel(), self._gradient.results[0].T.ravel()
        gradient[: len(point.packed)] = np.bincount(places, entries, len(point.packed))
        # The tracking cost of z_0 is no stage's.
        weights = point.packed[slices["stage.state_weights"]]
        first_reference = slices["stage.references"].start
        error = point.states[0] - point.packed[first_reference : first_reference + STATE_SIZE]
        gradient[slices["stage.state_weights"]] += error**2
        gradient[first_reference : first_reference + STATE_SIZE] -= 2 * weights * error
        gradient[slices[LOWER]] = point.lower_multipliers.sum(axis=0)
        gradient[slices[UPPER]] = -point.upper_multipliers.sum(axis=0)
        gradient[slices[INITIAL_STATE]] = point.costates[0]
        cost = self._interior_point.sweeps.forward(point.controls)[1] + float(weights @ error**2)
        # The factorisation's gradient has the slope of the barrier in it, unless u_0 is no variable.
        force = point.lower_multipliers[0] - point.upper_multipliers[0]
        action_gradient = np.where(point.free[0], force, point.factorisation.gradient[0])
        return Value(cost, gradient, point.controls[0].copy(), action_gradient, point.converged, point)
