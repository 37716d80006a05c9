"""The optimal control problem stage by stage, in the multiple-shooting form of the paper, with exact derivatives.

With w = (z_0 ... z_N, u_0 ... u_{N-1}) the Lagrange function of the paper (Sec. "MPC Sensitivities") is

    sum_k  node(z_{k+1}, u_k) + u_k' R u_k + lambda_{k+1}' (f(z_k, u_k) - z_{k+1})  +  terms of z_0 and the input set,

where `node` is the tracking cost of the reached state with its penalties. Braking into reverse is penalised by u_k and
z_{k+1} together, hence the cross term C between them. Everything is derived for one stage and repeated along the
horizon by CasADi, so that building takes little time and nothing is compiled.
"""

from __future__ import annotations

from functools import cached_property

import casadi

from mala_drake.buffered_function import densified
from mala_drake.control import model
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.shooting import (
    LIMIT_BUFFER,
    OBSTACLE_BUFFER,
    limit_margins,
    margin_penalty,
    obstacle_margins,
    reverse_braking,
    weighted_square,
)

from .stage_data import TARGET, WEIGHTS, StageData

_STATE, _CONTROL = model.STATE_SIZE, model.CONTROL_SIZE


class StageFunctions:
    """The expressions of one stage, and CasADi functions along the horizon, each created at first use.

    Attributes:
        data: what is known of the parameters of a stage.
        state, control, reached, costate, numbers: the symbols z_k, u_k, z_{k+1}, lambda_{k+1} and the stage's data.
        next_state: f(z_k, u_k).
        tracking, effort, penalties: the parts of the stage's cost, of z_{k+1} and u_k.

    Matrices of all stages stand side by side in the functions' arguments and results.
    """

    def __init__(self, problem: OptimalControlProblem) -> None:
        self.horizon = problem.horizon
        self.data = StageData(problem.layout)
        self.state, self.control = casadi.SX.sym("state", _STATE), casadi.SX.sym("control", _CONTROL)
        self.reached, self.costate = casadi.SX.sym("reached", _STATE), casadi.SX.sym("costate", _STATE)
        self.numbers = casadi.SX.sym("numbers", self.data.size)
        pieces = self.data.pieces(self.numbers)
        self.next_state = model.step(self.state, self.control, pieces["dynamics"], problem.period)
        self.tracking = weighted_square(self.reached - pieces[TARGET], pieces[WEIGHTS])
        self.effort = weighted_square(self.control, pieces["stage.control_weights"])
        to_obstacles, to_limits = obstacle_margins(self.reached, pieces), limit_margins(self.reached, 0, pieces)
        self.penalties = (
            pieces["constraints.obstacle_penalty"] * margin_penalty(to_obstacles, OBSTACLE_BUFFER)
            + pieces["constraints.limit_penalty"] * margin_penalty(to_limits, LIMIT_BUFFER)
            + pieces["constraints.reverse_braking_penalty"] * reverse_braking([self.reached], self.control)
        )

    @cached_property
    def forward(self) -> casadi.Function:
        """(z_0, U, data) -> (z_1 ... z_N, cost of each stage); the tracking cost of z_0 is a constant and left out."""
        cost = casadi.Function(
            "cost", [self.reached, self.control, self.numbers], [self.tracking + self.effort + self.penalties]
        )
        outputs = [self.next_state, cost(self.next_state, self.control, self.numbers)]
        return densified("stage", [self.state, self.control, self.numbers], outputs).mapaccum(
            "forward", self.horizon, 1
        )

    @cached_property
    def backward(self) -> casadi.Function:
        """One backward sweep: costates, the exact second-order model and its Riccati factorisation.

        The columns of every argument and result run from the last stage to the first. (P, lambda, s; z_k, u_k, z_{k+1},
        data_k, sigma_k, b_k, free_k) -> (P, lambda, s) before the node of stage k, and for the stage: lambda_{k+1},
        gradient with respect to u_k, P_{k+1}', A', B', C', K', M^-1, pivots of M, diagonal of M without sigma, and the
        Newton step's feed-forward. Arguments: sigma_k is the barrier's curvature and b_k its gradient; free_k is 0 for
        a control that is not a variable, else 1.
        """
        n, m = _STATE, _CONTROL
        value, multiplier, linear = casadi.SX.sym("P", n, n), casadi.SX.sym("l", n), casadi.SX.sym("s", n)
        curvature, slope, free = (casadi.SX.sym(name, m) for name in ("sigma", "b", "free"))
        node_gradient, node_hessian, cross = self._node_derivatives()
        costate = multiplier + node_gradient
        P = value + node_hessian
        A, B = casadi.jacobian(self.next_state, self.state), casadi.jacobian(self.next_state, self.control)
        D_zz, D_uz, D_uu = self._dynamics_curvature(costate)
        gradient = casadi.gradient(self.effort + self.penalties, self.control) + B.T @ costate + slope
        transfer = B.T @ P + cross
        bare = casadi.hessian(self.effort, self.control)[0] + D_uu + transfer @ B + (cross @ B).T
        mask = casadi.diag(free)
        M = mask @ (bare + casadi.diag(curvature)) @ mask + casadi.diag(1 - free)
        G = mask @ (D_uz + transfer @ A)
        inverse, pivots = _symmetric_inverse(M)
        gain = inverse @ G
        inverse = mask @ inverse @ mask
        rest = free * (gradient + B.T @ linear)
        feed_forward = inverse @ rest
        before = A.T @ P @ A + D_zz - G.T @ gain
        outputs = [
            (before + before.T) / 2,
            A.T @ costate,
            A.T @ linear - gain.T @ rest,
            *(costate, gradient, P.T, A.T, B.T, cross.T, gain.T, inverse, pivots, casadi.diag(bare), feed_forward),
        ]
        inputs = [value, multiplier, linear, self.state, self.control, self.reached, self.numbers]
        stage = densified("stage", [*inputs, curvature, slope, free], outputs)
        return stage.mapaccum("backward", self.horizon, 3)

    @cached_property
    def newton_step(self) -> casadi.Function:
        """(dz_0; A', B', K', feed-forward), first stage first -> (dz_1 ... dz_N, du_0 ... du_{N-1})."""
        n, m = _STATE, _CONTROL
        state, feed_forward = casadi.SX.sym("state", n), casadi.SX.sym("feed_forward", m)
        A, B, gain = casadi.SX.sym("A", n, n), casadi.SX.sym("B", m, n), casadi.SX.sym("K", n, m)
        control = -gain.T @ state - feed_forward
        stage = densified("stage", [state, A, B, gain, feed_forward], [A.T @ state + B.T @ control, control])
        return stage.mapaccum("newton_step", self.horizon, 1)

    @cached_property
    def parameter_gradient(self) -> casadi.Function:
        """(U, z_1 ... z_N, lambda_1 ... lambda_N, Z without z_N, data) -> gradient of L with respect to the data."""
        lagrangian = self.tracking + self.effort + self.penalties + casadi.dot(self.costate, self.next_state)
        inputs = [self.control, self.reached, self.costate, self.state, self.numbers]
        return densified("gradient", inputs, [casadi.gradient(lagrangian, self.numbers)]).map(self.horizon)

    def _node_derivatives(self) -> tuple[casadi.SX, casadi.SX, casadi.SX]:
        """Gradient and Hessian of the node's cost with respect to z_{k+1}, and C = d^2 node / du_k dz_{k+1}."""
        node = self.tracking + self.penalties
        hessian, gradient = casadi.hessian(node, self.reached)
        return gradient, hessian, casadi.jacobian(casadi.gradient(self.penalties, self.control), self.reached)

    def _dynamics_curvature(self, costate: casadi.SX) -> tuple[casadi.SX, casadi.SX, casadi.SX]:
        """Second derivatives of lambda' f: with respect to (z, z), (u, z) and (u, u)."""
        both = casadi.vertcat(self.state, self.control)
        hessian = casadi.hessian(casadi.dot(self.costate, self.next_state), both)[0]
        hessian = casadi.substitute(hessian, self.costate, costate)
        return hessian[:_STATE, :_STATE], hessian[_STATE:, :_STATE], hessian[_STATE:, _STATE:]


def _symmetric_inverse(matrix: casadi.SX) -> tuple[casadi.SX, casadi.SX]:
    """The inverse of a symmetric matrix by L D L', with D's diagonal, whose signs are those of the eigenvalues."""
    size = matrix.shape[0]
    lower, pivots = casadi.SX.eye(size), casadi.SX.zeros(size)
    for j in range(size):
        pivots[j] = matrix[j, j] - sum((lower[j, k] ** 2 * pivots[k] for k in range(j)), casadi.SX(0))
        for i in range(j + 1, size):
            known = sum((lower[i, k] * lower[j, k] * pivots[k] for k in range(j)), casadi.SX(0))
            lower[i, j] = (matrix[i, j] - known) / pivots[j]
    inverse_lower = casadi.SX.eye(size)
    for j in range(size):
        for i in range(j + 1, size):
            inverse_lower[i, j] = -sum((lower[i, k] * inverse_lower[k, j] for k in range(j, i)), casadi.SX(0))
    return inverse_lower.T @ casadi.diag(1 / pivots) @ inverse_lower, pivots
