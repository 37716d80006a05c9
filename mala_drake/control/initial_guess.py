"""Where a solve of the optimal control problem starts its search."""

from __future__ import annotations

import casadi
import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.buffered_function import BufferedFunction, densified

from .model import CONTROL_SIZE, StateIndex
from .optimal_control_problem import OptimalControlProblem
from .parameters import MpcParameters

Vector = NDArray[np.float64]

_VELOCITIES = [StateIndex.FORWARD_VELOCITY, StateIndex.YAW_RATE]


class InitialGuesses:
    """Candidates for the controls of the whole horizon, cheap to make; owns work arrays."""

    def __init__(self, problem: OptimalControlProblem) -> None:
        self._follow = BufferedFunction(_following(problem.horizon, problem.period))

    def __call__(self, state: Vector, parameters: MpcParameters, warm_start: ArrayLike | None) -> tuple[Vector, ...]:
        """Admissible controls, each of shape (N, 3): the warm start if there is one, tracking, and stopping.

        A warm start that is not finite is no candidate.
        """
        wanted, velocities, lower, upper = self._follow.arguments
        wanted[:, :-1] = parameters.stage.references[1:, _VELOCITIES].T
        wanted[:, -1] = parameters.terminal.target[_VELOCITIES]
        velocities[:, 0] = state[_VELOCITIES]
        lower[:, 0], upper[:, 0] = parameters.inputs.lower, parameters.inputs.upper
        self._follow()
        following, stopping = (result.T.copy() for result in self._follow.results)
        given = [np.minimum(np.maximum(w, lower[:, 0]), upper[:, 0]) for w in _usable(warm_start)]
        return (*given, following, stopping)


def _usable(warm_start: ArrayLike | None) -> list[Vector]:
    controls = np.full(1, np.nan) if warm_start is None else np.asarray(warm_start, dtype=float)
    return [controls] if np.isfinite(controls).all() else []


def _following(horizon: int, period: float) -> casadi.Function:
    """(wanted velocities, present ones, lower, upper) -> (controls that reach them, controls that stop).

    Both approach the velocities, shape (2, N), as fast as the input set admits, and have shape (3, N).
    """
    wanted, velocities = casadi.SX.sym("wanted", len(_VELOCITIES), horizon), casadi.SX.sym("now", len(_VELOCITIES))
    lower, upper = casadi.SX.sym("lower", CONTROL_SIZE), casadi.SX.sym("upper", CONTROL_SIZE)
    sequences = []
    for goals in (wanted, casadi.SX.zeros(wanted.shape)):
        speed, turn, controls = velocities[0], velocities[1], []
        for k in range(horizon):
            acceleration = (goals[0, k] - speed) / period
            braking = casadi.if_else(speed > 0, casadi.fmax(-acceleration, 0) / 2, 0)
            wish = casadi.vertcat(acceleration + braking, braking, (goals[1, k] - turn) / period)
            control = casadi.fmin(casadi.fmax(wish, lower), upper)
            speed, turn = speed + period * (control[0] - control[1]), turn + period * control[2]
            controls.append(control)
        sequences.append(casadi.horzcat(*controls))
    return densified("following", [wanted, velocities, lower, upper], sequences)
