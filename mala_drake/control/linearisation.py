"""The optimal control problem linearised along a trajectory, stage by stage and all stages at once.

The cost is smooth tracking plus penalties price * phi(excess) of margins. Tracking is given by its gradients and its
diagonal Hessian, the dynamics by A_k and B_k, and each penalty by a *row*: its excess, the excess's slope, its price
and its width. A row is kept apart from the cost because phi is quadratic on one side only: a model that folds it into
the Hessian knows nothing of an obstacle that is still a step away.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi
import numpy as np
from numpy.typing import NDArray

from mala_drake.buffered_function import BufferedFunction, densified

from . import model
from .model import ControlIndex, StateIndex
from .optimal_control_problem import OptimalControlProblem
from .penalty import hinge_slope, huberised_hinge
from .shooting import LIMIT_BUFFER, LIMITS, OBSTACLE_BUFFER, limit_margins, obstacle_margins, parameter_pieces

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Linearisation:
    """What the model of one Gauss-Newton step is made of. Stages count 1 ... N for states and 0 ... N - 1 for controls.

    The R rows of a stage are its M obstacles, its path limits in the order of `LIMITS`, and reverse braking.
    """

    states: Vector  # z_0 ... z_N, shape (N + 1, 6).
    transitions: Vector  # A, shape (N, 6, 6).
    inputs: Vector  # B, shape (N, 6, 3).
    state_gradients: Vector  # Of tracking, shape (N, 6).
    control_gradients: Vector  # Of tracking, and of reverse braking with the speed held, shape (N, 3).
    state_weights: Vector  # Diagonal Hessian of tracking, shape (N, 6).
    control_weights: Vector  # The same, shape (N, 3).
    excesses: Vector  # Shape (N, R); positive where a penalty is active.
    slopes: Vector  # d excess / d z, shape (N, R, 6).
    prices: Vector  # Shape (N, R).
    couplings: Vector  # Second derivatives of reverse braking by brake and backward speed, shape (N,).
    widths: Vector  # Of the quadratic piece of phi, shape (R,).

    def margins(self, slots: int) -> Vector:
        """Distance less required distance of the obstacles in the `slots`, shape (N, slots), metres."""
        return OBSTACLE_BUFFER - self.excesses[:, :slots]


class Lineariser:
    """Evaluates a problem's `Linearisation`; owns work arrays."""

    def __init__(self, problem: OptimalControlProblem) -> None:
        self._horizon = problem.horizon
        self._rows = problem.layout.slots + len(LIMITS) + 1
        self._function = BufferedFunction(_all_stages(problem))
        self._widths = np.full(self._rows, LIMIT_BUFFER)
        self._widths[: problem.layout.slots] = OBSTACLE_BUFFER

    def __call__(self, initial_state: Vector, controls: Vector, packed: Vector) -> Linearisation:
        """Linearises along the trajectory from z_0, shape (6,), under `controls`, shape (N, 3), with parameters p."""
        values = (controls.T, initial_state[:, None], packed[:, None])
        for argument, value in zip(self._function.arguments, values, strict=True):
            argument[:] = value
        self._function()
        n, m, horizon = model.STATE_SIZE, model.CONTROL_SIZE, self._horizon
        (
            states,
            a,
            b,
            state_gradients,
            control_gradients,
            state_weights,
            control_weights,
            excesses,
            slopes,
            prices,
            couplings,
        ) = (result.T.copy() for result in self._function.results)
        return Linearisation(
            states=states,
            transitions=a.reshape(horizon, n, n).transpose(0, 2, 1),
            inputs=b.reshape(horizon, m, n).transpose(0, 2, 1),
            state_gradients=state_gradients,
            control_gradients=control_gradients,
            state_weights=state_weights,
            control_weights=control_weights,
            excesses=excesses,
            slopes=slopes.reshape(horizon, self._rows, n),
            prices=prices,
            couplings=couplings[:, 0],
            widths=self._widths,
        )


def _all_stages(problem: OptimalControlProblem) -> casadi.Function:
    """(U, z_0, p) -> the fields of `Linearisation` up to the couplings, one column (or block of columns) a stage."""
    parameters = casadi.SX.sym("parameters", problem.layout.size)
    pieces = parameter_pieces(problem.layout, parameters)
    controls = casadi.SX.sym("controls", model.CONTROL_SIZE, problem.horizon)
    initial_state = casadi.SX.sym("initial_state", model.STATE_SIZE)
    state, states = initial_state, [initial_state]
    columns: list[list[casadi.SX]] = [[] for _ in range(10)]
    for k in range(problem.horizon):
        state, *jacobians = problem.stage(state, controls[:, k], pieces["dynamics"])
        states.append(state)
        values = (*jacobians, *_tracking(state, controls[:, k], k, problem, pieces))
        rows = _rows(problem, k)(state, controls[:, k], parameters)
        for column, value in zip(columns, (*values, *rows), strict=True):
            column.append(value)
    outputs = [casadi.horzcat(*states), *(casadi.horzcat(*column) for column in columns)]
    return densified("linearisation", [controls, initial_state, parameters], outputs)


def _tracking(
    state: casadi.SX, control: casadi.SX, stage: int, problem: OptimalControlProblem, pieces: dict[str, casadi.SX]
) -> tuple[casadi.SX, casadi.SX, casadi.SX, casadi.SX]:
    """Gradients and diagonal Hessians by z_{stage + 1} and u_stage: tracking, and braking while the speed is held."""
    last = stage == problem.horizon - 1
    wanted = pieces["terminal.target"] if last else pieces["stage.references"][stage + 1, :].T
    state_weights = 2 * (pieces["terminal.weights"] if last else pieces["stage.state_weights"])
    control_weights = 2 * pieces["stage.control_weights"]
    braking = casadi.SX.zeros(model.CONTROL_SIZE)
    backward = huberised_hinge(-state[StateIndex.FORWARD_VELOCITY], LIMIT_BUFFER)
    braking[ControlIndex.BRAKE] = pieces["constraints.reverse_braking_penalty"] * backward
    return state_weights * (state - wanted), control_weights * control + braking, state_weights, control_weights


def _rows(problem: OptimalControlProblem, stage: int) -> casadi.Function:
    """(z, u, p) -> (excesses, their slopes as columns, prices, coupling) after `stage`."""
    state, control = casadi.SX.sym("state", model.STATE_SIZE), casadi.SX.sym("control", model.CONTROL_SIZE)
    parameters = casadi.SX.sym("parameters", problem.layout.size)
    pieces = parameter_pieces(problem.layout, parameters)
    reversing = pieces["constraints.reverse_braking_penalty"]
    backward = -state[StateIndex.FORWARD_VELOCITY]
    excesses = casadi.vertcat(
        OBSTACLE_BUFFER - obstacle_margins(state, pieces),
        LIMIT_BUFFER - limit_margins(state, stage, pieces),
        backward,
    )
    prices = casadi.vertcat(
        casadi.repmat(pieces["constraints.obstacle_penalty"], problem.layout.slots, 1),
        casadi.repmat(pieces["constraints.limit_penalty"], len(LIMITS), 1),
        reversing * casadi.fmax(control[ControlIndex.BRAKE], 0),
    )
    coupling = reversing * hinge_slope(backward, LIMIT_BUFFER)
    outputs = [excesses, casadi.jacobian(excesses, state).T, prices, coupling]
    return densified("rows", [state, control, parameters], outputs)
