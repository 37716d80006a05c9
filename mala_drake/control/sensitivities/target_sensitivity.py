"""How the end of a leg moves with its target: the closed-loop sensitivity that targets are learned through."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mala_drake.control.model import STATE_SIZE, StateIndex
from mala_drake.messages import DrivenLeg

from .columns import Columns
from .leg_parameters import ScheduledParameters
from .leg_sensitivity import adjoint
from .leg_simulator import LegSimulator
from .recorded_leg import KNOBS, NOMINAL, RecordedLeg

Vector = NDArray[np.float64]

_FORGOTTEN = 0.1  # Metres at the end of a leg by metres (radians, ...) at a state that it does not depend on.
_TARGET = [KNOBS.index("target x"), KNOBS.index("target y")]


class TargetSensitivity:
    """Simulates a leg in closed loop over the prediction model and differentiates its end by its target."""

    def __init__(self, simulator: LegSimulator) -> None:
        """Makes it."""
        self._simulator = simulator

    def __call__(self, leg: DrivenLeg) -> Vector:
        """D (x, y at the end) / d (x, y of the target), shape (2, 2), by the adjoint mode.

        Raises:
            RuntimeError: the simulated leg does not succeed, or its end has no derivative.
        """
        run = self._simulator(leg, _by_knobs)
        tail = run.tail
        if not tail.steps:
            raise RuntimeError("has no derivative at its end")
        gradients = [adjoint(tail, end) for end in np.eye(STATE_SIZE)[[StateIndex.X, StateIndex.Y]]]
        whole = len(tail.steps) == len(run.steps)
        if not whole and max(np.abs(gradient.by_initial_state).max() for gradient in gradients) > _FORGOTTEN:
            raise RuntimeError("has no derivative near its end")
        return np.array([gradient.by_knobs[_TARGET] for gradient in gradients])


def _by_knobs(leg: RecordedLeg, columns: Columns) -> ScheduledParameters:
    return leg.with_knobs(NOMINAL, columns)
