"""Where a solve of the optimal control problem starts its search."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .model import StateIndex
from .parameters import MpcParameters

Vector = NDArray[np.float64]


def initial_guesses(
    state: Vector, parameters: MpcParameters, period: float, warm_start: ArrayLike | None
) -> tuple[Vector, ...]:
    """Admissible candidate controls, each of shape (N, 3): the warm start if there is one, tracking, and stopping.

    A warm start that is not finite is no candidate.
    """
    references = np.vstack((parameters.stage.references[1:], parameters.terminal.target))
    at_rest = np.zeros_like(references)
    lower, upper = parameters.inputs.lower, parameters.inputs.upper
    given = [np.clip(w, lower, upper) for w in _usable(warm_start)]
    return (*given, *(_follow(state, wanted, parameters, period) for wanted in (references, at_rest)))


def _usable(warm_start: ArrayLike | None) -> list[Vector]:
    controls = np.full(1, np.nan) if warm_start is None else np.asarray(warm_start, dtype=float)
    return [controls] if np.isfinite(controls).all() else []


def _follow(state: Vector, wanted: Vector, parameters: MpcParameters, period: float) -> Vector:
    """Controls whose velocities approach those of `wanted`, shape (N, 6), as fast as the input set admits.

    Plain numbers: twenty stages one after another are ten times slower as arrays of three.
    """
    (low, low_brake, low_turn), (high, high_brake, high_turn) = (
        bound.tolist() for bound in (parameters.inputs.lower, parameters.inputs.upper)
    )
    velocity, yaw_rate = float(state[StateIndex.FORWARD_VELOCITY]), float(state[StateIndex.YAW_RATE])
    controls = []
    for speed, turn in wanted[:, [StateIndex.FORWARD_VELOCITY, StateIndex.YAW_RATE]].tolist():
        acceleration = (speed - velocity) / period
        braking = max(-acceleration, 0.0) / 2 if velocity > 0 else 0.0
        propulsion = min(max(acceleration + braking, low), high)
        braking = min(max(braking, low_brake), high_brake)
        turning = min(max((turn - yaw_rate) / period, low_turn), high_turn)
        controls.append((propulsion, braking, turning))
        velocity += period * (propulsion - braking)
        yaw_rate += period * turning
    return np.array(controls)
