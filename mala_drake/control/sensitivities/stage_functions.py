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
from mala_drake.control.gauss_newton import penalty_weight, reweighted
from mala_drake.control.model import ControlIndex, StateIndex
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

from .riccati import Curvature, StageDerivatives, backward_stage
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
        """The backward sweep of `riccati.py` with exact second derivatives."""
        node = casadi.hessian(self.tracking + self.penalties, self.reached)[0]
        cross = casadi.jacobian(casadi.gradient(self.penalties, self.control), self.reached)
        both = casadi.vertcat(self.state, self.control)
        dynamics = casadi.hessian(casadi.dot(self.costate, self.next_state), both)[0]
        return self._sweep("backward", Curvature(node, cross, dynamics))

    @cached_property
    def convex_backward(self) -> casadi.Function:
        """The same sweep with a convex model in the place of the exact one: that of Gauss and Newton."""
        pieces = self.data.pieces(self.numbers)
        backward = self.reached[StateIndex.FORWARD_VELOCITY] + LIMIT_BUFFER
        braking = pieces["constraints.reverse_braking_penalty"] * self.control[ControlIndex.BRAKE]
        node = (
            casadi.hessian(self.tracking, self.reached)[0]
            + penalty_weight(self.reached, 0, pieces)
            + reweighted(backward, LIMIT_BUFFER, braking, self.reached)
        )
        nothing = casadi.SX(_STATE + _CONTROL, _STATE + _CONTROL)
        return self._sweep("convex_backward", Curvature(node, casadi.SX(_CONTROL, _STATE), nothing))

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

    def _sweep(self, name: str, curvature: Curvature) -> casadi.Function:
        """The sweep along the horizon with the curvature of one stage."""
        derivatives = StageDerivatives(
            by_state=casadi.jacobian(self.next_state, self.state),
            by_control=casadi.jacobian(self.next_state, self.control),
            node_gradient=casadi.gradient(self.tracking + self.penalties, self.reached),
            control_gradient=casadi.gradient(self.effort + self.penalties, self.control),
            effort=casadi.hessian(self.effort, self.control)[0],
            curvature=curvature,
        )
        arguments = [self.state, self.control, self.reached, self.numbers]
        return backward_stage(derivatives, self.costate, arguments).mapaccum(name, self.horizon, 3)
