"""Sweeps along the horizon: rollout, costates with the factorised second-order model, and Newton steps."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mala_drake.buffered_function import BufferedFunction
from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE
from mala_drake.messages import Message

from .stage_functions import StageFunctions

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Factorisation(Message):
    """The KKT system of one trajectory with the states eliminated stage by stage (Riccati). Stage k is row k.

    The condensed Hessian is positive definite exactly if all pivots are positive: they are those of its block L D L'.
    """

    costates: Vector  # lambda_1 ... lambda_N, shape (N, 6).
    gradient: Vector  # Of the Lagrange function with respect to u_k, shape (N, 3).
    value: Vector  # P_{k+1}, second derivative of the cost to go with z_{k+1}'s node, shape (N, 6, 6).
    A: Vector  # d z_{k+1} / d z_k, shape (N, 6, 6).
    B: Vector  # d z_{k+1} / d u_k, shape (N, 6, 3).
    cross: Vector  # C = d^2 node / d u_k d z_{k+1}, shape (N, 3, 6).
    gain: Vector  # K: a small dz_k is answered by du_k = -K dz_k, shape (N, 3, 6).
    inverse: Vector  # M^-1, zero for controls that are not free, shape (N, 3, 3).
    pivots: Vector  # Shape (N, 3); 1 for controls that are not free.
    curvature: Vector  # Diagonal of M without the barrier's share, shape (N, 3).
    feed_forward: Vector  # Of the Newton step, shape (N, 3).
    initial_value: Vector  # P_0 without the node of z_0, shape (6, 6).
    initial_costate: Vector  # lambda_0 without the node of z_0, shape (6,).


class Sweeps:
    """Evaluates `StageFunctions` for one initial state and parameter vector at a time. Owns work arrays."""

    def __init__(self, functions: StageFunctions) -> None:
        self._functions = functions
        self._horizon = functions.horizon
        self._forward = BufferedFunction(functions.forward)
        self._backward = BufferedFunction(functions.backward)
        self._newton = BufferedFunction(functions.newton_step)
        self._initial_state = np.zeros(STATE_SIZE)
        self._reversed_data = np.zeros((functions.data.size, functions.horizon))

    def set_parameters(self, initial_state: Vector, packed: Vector) -> None:
        """Chooses z_0, shape (6,), and p for the sweeps to come."""
        data = packed[self._functions.data.sources]
        self._initial_state = np.array(initial_state, dtype=float)
        self._forward.arguments[0][:, 0] = initial_state
        self._forward.arguments[2][:] = data.T
        self._reversed_data = data[::-1].T

    def forward(self, controls: Vector) -> tuple[Vector, float]:
        """The states, shape (N + 1, 6), and the cost without the tracking cost of z_0."""
        self._forward.arguments[1][:] = controls.T
        self._forward()
        states, costs = self._forward.results
        return np.vstack((self._initial_state, states.T)), float(costs.sum())

    def backward(
        self,
        states: Vector,
        controls: Vector,
        *,
        curvature: Vector,
        slope: Vector,
        free: Vector,
        convex: bool = False,
    ) -> Factorisation:
        """Costates and factorisation at a trajectory.

        Args:
            states: z_0 ... z_N, shape (N + 1, 6).
            controls: shape (N, 3).
            curvature: second derivative of what is added to the cost of each control, shape (N, 3).
            slope: its first derivative, shape (N, 3).
            free: 1 for controls that are variables, 0 for the others, shape (N, 3).
            convex: whether a convex model of the cost is factorised in the place of the exact one.
        """
        function = self._convex if convex else self._backward
        function.arguments[6][:] = self._reversed_data
        for index, rows in ((3, states[:-1]), (4, controls), (5, states[1:]), (7, curvature), (8, slope), (9, free)):
            function.arguments[index][:] = rows[::-1].T
        function()
        P, multiplier, _, costate, gradient, value, A, B, cross, gain, inverse, pivots, bare, feed_forward = (
            result.T for result in function.results
        )
        n, m = STATE_SIZE, CONTROL_SIZE
        return Factorisation(
            costates=self._stages(costate, n),
            gradient=self._stages(gradient, m),
            value=self._stages(value, n, n),
            A=self._stages(A, n, n),
            B=self._stages(B, n, m),
            cross=self._stages(cross, m, n),
            gain=self._stages(gain, m, n),
            inverse=self._stages(inverse, m, m),
            pivots=self._stages(pivots, m),
            curvature=self._stages(bare, m),
            feed_forward=self._stages(feed_forward, m),
            initial_value=P[-n:].copy(),
            initial_costate=multiplier[-1].copy(),
        )

    def newton_step(self, factorisation: Factorisation) -> Vector:
        """The change of the controls, shape (N, 3), that minimises the second-order model."""
        arguments = self._newton.arguments
        arguments[1][:] = factorisation.A.reshape(-1, STATE_SIZE).T
        arguments[2][:] = factorisation.B.reshape(-1, CONTROL_SIZE).T
        arguments[3][:] = factorisation.gain.reshape(-1, STATE_SIZE).T
        arguments[4][:] = factorisation.feed_forward.T
        self._newton()
        return self._newton.results[1].T.copy()

    @cached_property
    def _convex(self) -> BufferedFunction:
        """Needed only far from solutions, hence made at first use."""
        return BufferedFunction(self._functions.convex_backward)

    def _stages(self, rows: Vector, *shape: int) -> Vector:
        """One entry a stage, the first stage first."""
        return np.ascontiguousarray(rows.reshape(self._horizon, *shape)[::-1])
