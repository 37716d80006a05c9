"""What line searches ask of the optimal control problem: cost, gradient and trajectory of given controls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mala_drake.buffered_function import BufferedFunction

from .optimal_control_problem import OptimalControlProblem

Vector = NDArray[np.float64]


class Evaluation:
    """The problem at one initial state with one parameter vector p; owns work arrays."""

    def __init__(self, problem: OptimalControlProblem) -> None:
        self._cost = BufferedFunction(problem.cost)
        self._cost_and_gradient = BufferedFunction(problem.cost_and_gradient)
        self._trajectory = BufferedFunction(problem.trajectory)

    def set(self, initial_state: Vector, packed: Vector) -> None:
        """Chooses z_0, shape (6,), and p for the evaluations to come."""
        for function in (self._cost, self._cost_and_gradient, self._trajectory):
            function.arguments[1][:, 0], function.arguments[2][:, 0] = initial_state, packed

    def cost(self, controls: Vector) -> float:
        """The cost of `controls`, shape (N, 3)."""
        self._cost.arguments[0][:] = controls.T
        self._cost()
        return float(self._cost.results[0][0, 0])

    def cost_and_gradient(self, controls: Vector) -> tuple[float, Vector]:
        """The cost and its gradient, shape (N, 3), at `controls`, shape (N, 3)."""
        self._cost_and_gradient.arguments[0][:] = controls.T
        self._cost_and_gradient()
        cost, gradient = self._cost_and_gradient.results
        return float(cost[0, 0]), np.array(gradient.T, order="C")

    def trajectory(self, controls: Vector) -> list[Vector]:
        """States, obstacle margins, limit margins and both multipliers along `controls`, one row a stage."""
        self._trajectory.arguments[0][:] = controls.T
        self._trajectory()
        return [np.array(result.T, order="C") for result in self._trajectory.results]

    def best(self, candidates: tuple[Vector, ...]) -> tuple[Vector, float]:
        """The candidate of lowest cost, and its cost.

        A warm start that went bad must not decide which local optimum is found.
        """
        costs = [self.cost(candidate) for candidate in candidates]
        chosen = int(np.argmin(np.where(np.isfinite(costs), costs, np.inf)))
        return candidates[chosen], costs[chosen]
