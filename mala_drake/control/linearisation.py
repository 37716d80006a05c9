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
from .penalty import huberised_hinge
from .shooting import LIMIT_BUFFER, LIMITS, OBSTACLE_BUFFER, limit_margins, obstacle_margins, parameter_pieces

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Linearisation:
    """What the model of one Gauss-Newton step is made of. Stages count 1 ... N for states and 0 ... N - 1 for controls.

    The R rows of a stage are its M obstacles, its path limits in the order of `LIMITS`, and reverse braking.
    """

    transitions: Vector  # A, shape (N, 6, 6).
    inputs: Vector  # B, shape (N, 6, 3).
    state_gradients: Vector  # Of tracking, shape (N, 6).
    control_gradients: Vector  # Of tracking, and of reverse braking with the speed held, shape (N, 3).
    state_weights: Vector  # Diagonal Hessian of tracking, shape (N, 6).
    control_weights: Vector  # The same, shape (N, 3).
    excesses: Vector  # Shape (N, R); positive where a penalty is active.
    slopes: Vector  # d excess / d z, shape (N, R, 6).
    prices: Vector  # Shape (N, R).
    widths: Vector  # Of the quadratic piece of phi, shape (R,).


class Lineariser:
    """Evaluates a problem's `Linearisation`; owns work arrays."""

    def __init__(self, problem: OptimalControlProblem) -> None:
        self._horizon = problem.horizon
        self._rows = problem.layout.slots + len(LIMITS) + 1
        self._function = BufferedFunction(_stage_functions(problem))
        self._widths = np.full(self._rows, LIMIT_BUFFER)
        self._widths[: problem.layout.slots] = OBSTACLE_BUFFER

    def __call__(self, states: Vector, controls: Vector, packed: Vector) -> Linearisation:
        """Linearises along `states`, shape (N + 1, 6), and `controls`, shape (N, 3), with the parameters p."""
        for argument, value in zip(self._function.arguments, (states.T, controls.T, packed[:, None]), strict=True):
            argument[:] = value
        self._function()
        n, m, horizon = model.STATE_SIZE, model.CONTROL_SIZE, self._horizon
        a, b, state_gradients, control_gradients, state_weights, control_weights, excesses, slopes, prices = (
            result.T.copy() for result in self._function.results
        )
        return Linearisation(
            transitions=a.reshape(horizon, n, n).transpose(0, 2, 1),
            inputs=b.reshape(horizon, m, n).transpose(0, 2, 1),
            state_gradients=state_gradients,
            control_gradients=control_gradients,
            state_weights=state_weights,
            control_weights=control_weights,
            excesses=excesses,
            slopes=slopes.reshape(horizon, self._rows, n),
            prices=prices,
            widths=self._widths,
        )


def _stage_functions(problem: OptimalControlProblem) -> casadi.Function:
    """(Z, U, p) -> the fields of `Linearisation`, one column (or block of columns) a stage."""
    parameters = casadi.SX.sym("parameters", problem.layout.size)
    pieces = parameter_pieces(problem.layout, parameters)
    states = casadi.SX.sym("states", model.STATE_SIZE, problem.horizon + 1)
    controls = casadi.SX.sym("controls", model.CONTROL_SIZE, problem.horizon)
    columns: list[list[casadi.SX]] = [[] for _ in range(7)]
    for k in range(problem.horizon):
        last = k == problem.horizon - 1
        reached, control = states[:, k + 1], controls[:, k]
        wanted = pieces["terminal.target"] if last else pieces["stage.references"][k + 1, :].T
        state_weights = 2 * (pieces["terminal.weights"] if last else pieces["stage.state_weights"])
        control_weights = 2 * pieces["stage.control_weights"]
        reversing = pieces["constraints.reverse_braking_penalty"]
        backward = -reached[StateIndex.FORWARD_VELOCITY]
        control_gradient = control_weights * control
        control_gradient[ControlIndex.BRAKE] += reversing * huberised_hinge(backward, LIMIT_BUFFER)
        excess = casadi.vertcat(
            OBSTACLE_BUFFER - obstacle_margins(reached, pieces),
            LIMIT_BUFFER - limit_margins(reached, k, pieces),
            backward,
        )
        prices = casadi.vertcat(
            casadi.repmat(pieces["constraints.obstacle_penalty"], problem.layout.slots, 1),
            casadi.repmat(pieces["constraints.limit_penalty"], len(LIMITS), 1),
            reversing * casadi.fmax(control[ControlIndex.BRAKE], 0),
        )
        stage = (
            state_weights * (reached - wanted),
            control_gradient,
            state_weights,
            control_weights,
            excess,
            casadi.jacobian(excess, reached).T,
            prices,
        )
        for column, value in zip(columns, stage, strict=True):
            column.append(value)
    jacobians = problem.stage_jacobians(states[:, :-1], controls, pieces["dynamics"])
    outputs = [*jacobians, *(casadi.horzcat(*column) for column in columns)]
    return densified("linearisation", [states, controls, parameters], outputs)
