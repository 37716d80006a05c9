"""The Gauss-Newton model of the shooting problem: stage Jacobians, stage weights, and the condensed Hessian.

Quadratic costs enter exactly and penalties through the weight phi'(e) / e of iteratively reweighted least squares (the
true curvature within the buffer, a majorising one beyond it), so that the Hessian is positive definite everywhere. The
curvature of the dynamics is left out (Nocedal & Wright, Numerical Optimization, 2nd ed., Sec. 10.3).
"""

from __future__ import annotations

import casadi
import numpy as np
from numpy.typing import NDArray

from mala_drake.buffered_function import BufferedFunction, densified

from . import model
from .condensing import state_sensitivities
from .optimal_control_problem import OptimalControlProblem
from .shooting import LIMIT_BUFFER, OBSTACLE_BUFFER, limit_margins, obstacle_margins, parameter_pieces


def stage_model(problem: OptimalControlProblem) -> casadi.Function:
    """(Z, U, p) -> (A, B, W): the linearisation along a trajectory.

    A = d z_{k+1} / d z_k side by side, shape (6, 6 N); B = d z_{k+1} / d u_k, shape (6, 3 N); W, shape (6, 6 N), the
    weights of stages 1 ... N, such that the cost of a small deviation dz_k is about dz_k' W_k dz_k / 2.
    """
    parameters = casadi.SX.sym("parameters", problem.layout.size)
    pieces = parameter_pieces(problem.layout, parameters)
    states = casadi.SX.sym("states", model.STATE_SIZE, problem.horizon + 1)
    controls = casadi.SX.sym("controls", model.CONTROL_SIZE, problem.horizon)
    weights = []
    for k in range(problem.horizon):
        last = k == problem.horizon - 1
        tracking = pieces["terminal.weights"] if last else pieces["stage.state_weights"]
        weights.append(2 * casadi.diag(tracking) + penalty_weight(states[:, k + 1], k, pieces))
    jacobians = problem.stage_jacobians(states[:, :-1], controls, pieces["dynamics"])
    return densified("stage_model", [states, controls, parameters], [*jacobians, casadi.horzcat(*weights)])


class GaussNewtonModel:
    """Condenses the stage model: eliminates the states, so that only the controls remain."""

    def __init__(self, problem: OptimalControlProblem) -> None:
        self._horizon = problem.horizon
        self._stage_model = BufferedFunction(stage_model(problem))

    def hessian(
        self,
        states: NDArray[np.float64],
        controls: NDArray[np.float64],
        packed: NDArray[np.float64],
        control_weights: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """The Hessian of the cost with respect to (u_0 ... u_{N-1}), shape (3 N, 3 N), positive definite.

        Args:
            states: z_0 ... z_N, shape (N + 1, 6).
            controls: u_0 ... u_{N-1}, shape (N, 3).
            packed: the parameter vector p.
            control_weights: R's diagonal, shape (3,).
        """
        for argument, value in zip(self._stage_model.arguments, (states.T, controls.T, packed[:, None]), strict=True):
            argument[:] = value
        self._stage_model()
        n, m, horizon = model.STATE_SIZE, model.CONTROL_SIZE, self._horizon
        transitions, inputs, weights = (result.T for result in self._stage_model.results)
        sensitivities = state_sensitivities(
            transitions.reshape(horizon, n, n).transpose(0, 2, 1), inputs.reshape(horizon, m, n).transpose(0, 2, 1)
        )
        weighted = np.zeros_like(sensitivities)
        np.matmul(weights.reshape(horizon, n, n), sensitivities, out=weighted)
        size = m * horizon
        hessian = sensitivities.reshape(-1, size).T @ weighted.reshape(-1, size)
        hessian.flat[:: size + 1] += np.tile(2 * control_weights, horizon)
        return hessian


def penalty_weight(state: casadi.SX, stage: int, pieces: dict[str, casadi.SX]) -> casadi.SX:
    """The share of the penalties of one stage, a (6, 6) matrix; taken by the few states that the margins depend on."""
    obstacles, limits = obstacle_margins(state, pieces), limit_margins(state, stage, pieces)
    return reweighted(obstacles, OBSTACLE_BUFFER, pieces["constraints.obstacle_penalty"], state) + reweighted(
        limits, LIMIT_BUFFER, pieces["constraints.limit_penalty"], state
    )


def reweighted(margins: casadi.SX, buffer: float, penalty: casadi.SX, state: casadi.SX) -> casadi.SX:
    """The convex curvature, a (6, 6) matrix, of `penalty` times the Huberised hinges of buffer - margins."""
    excess = casadi.fmax(buffer - margins, 0)
    curvature = penalty * (excess > 0) / casadi.fmax(excess, buffer)
    slopes = casadi.jacobian(margins, state)
    return slopes.T @ (slopes * casadi.repmat(curvature, 1, model.STATE_SIZE))
