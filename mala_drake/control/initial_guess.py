"""Where a solve of the optimal control problem starts its search."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .model import ControlIndex, StateIndex
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
    """Controls whose velocities approach those of `wanted`, shape (N, 6), as fast as the input set admits."""
    controls = np.zeros((len(wanted), len(ControlIndex)))
    lower, upper = parameters.inputs.lower, parameters.inputs.upper
    velocity, yaw_rate = state[StateIndex.FORWARD_VELOCITY], state[StateIndex.YAW_RATE]
    for control, goal in zip(controls, wanted, strict=True):
        acceleration = (goal[StateIndex.FORWARD_VELOCITY] - velocity) / period
        braking = max(-acceleration, 0.0) / 2 if velocity > 0 else 0.0
        control[ControlIndex.PROPULSION] = acceleration + braking
        control[ControlIndex.BRAKE] = braking
        control[ControlIndex.YAW_ACCELERATION] = (goal[StateIndex.YAW_RATE] - yaw_rate) / period
        control[:] = np.clip(control, lower, upper)
        velocity += period * (control[ControlIndex.PROPULSION] - control[ControlIndex.BRAKE])
        yaw_rate += period * control[ControlIndex.YAW_ACCELERATION]
    return controls
