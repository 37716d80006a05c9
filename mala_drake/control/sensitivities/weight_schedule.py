"""A recorded leg with other weights: the diagonals of Q and R as knobs, each by the logarithm of a factor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE
from mala_drake.control.parameters import MpcParameters

from .columns import Columns
from .leg_parameters import ScheduledParameters, StepParameters
from .recorded_leg import RecordedLeg

WEIGHT_KNOBS = STATE_SIZE + CONTROL_SIZE
"""Entries of Q's diagonal, each with its share of the terminal weights, then of R's."""


def weight_schedule(leg: RecordedLeg, logarithms: ArrayLike, columns: Columns) -> ScheduledParameters:
    """The leg's parameters with the weights times exp(`logarithms`), shape (9,), and their derivatives by those."""
    values = np.asarray(logarithms, dtype=float)
    return ScheduledParameters([_step(step, values, columns) for step in leg.steps], ("terminal", "stage"))


def _step(parameters: MpcParameters, logarithms: np.ndarray, columns: Columns) -> StepParameters:
    terminal, stage = parameters.terminal, parameters.stage
    columns = columns.of_horizon(parameters.horizon)
    on_states, on_controls = np.exp(logarithms[:STATE_SIZE]), np.exp(logarithms[STATE_SIZE:])
    weighted = replace(
        parameters,
        terminal=replace(terminal, weights=terminal.weights * on_states),
        stage=replace(
            stage, state_weights=stage.state_weights * on_states, control_weights=stage.control_weights * on_controls
        ),
    )
    by_knobs = np.zeros((columns.parameters.stop, WEIGHT_KNOBS))
    by_knobs[columns.of(["terminal.weights"]), :STATE_SIZE] = np.diag(weighted.terminal.weights)
    by_knobs[columns.of(["stage.state_weights"]), :STATE_SIZE] = np.diag(weighted.stage.state_weights)
    by_knobs[columns.of(["stage.control_weights"]), STATE_SIZE:] = np.diag(weighted.stage.control_weights)
    return StepParameters(weighted, by_knobs)
