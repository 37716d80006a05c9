"""What it costs to be off the reference: the controller's cost functions, of single states and controls."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .leg import Pose
from .model import STATE_SIZE, StateIndex
from .parameters import StageParameters, TerminalParameters

Vector = NDArray[np.float64]


def stage_cost(state: Vector, control: Vector, stage: StageParameters) -> float:
    """G(z, v; p^g) of one executed step: a state, shape (6,), and its control, shape (3,), by the first reference."""
    effort = float(control @ (stage.control_weights * control))
    return effort + _squared_error(state, stage.references[0], stage.state_weights)


def terminal_cost(state: Vector, target: Pose, terminal: TerminalParameters) -> float:
    """W(z; p^w) of the state that a leg ended in, shape (6,), which was to be at rest in its target pose."""
    return _squared_error(state, np.concatenate((target, np.zeros(STATE_SIZE - len(target)))), terminal.weights)


def _squared_error(state: Vector, wanted: Vector, weights: Vector) -> float:
    error = state - wanted
    error[StateIndex.YAW] = math.remainder(error[StateIndex.YAW], math.tau)
    return float(error @ (weights * error))
