"""How the cost of a leg moves with the weights that it is driven with: what p^g is learned through."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from mala_drake.messages import DrivenLeg

from .columns import Columns
from .leg_cost import LegCost
from .leg_parameters import ScheduledParameters
from .leg_sensitivity import adjoint
from .leg_simulator import LegSimulator
from .recorded_leg import RecordedLeg
from .weight_schedule import WEIGHT_KNOBS, weight_schedule

Vector = NDArray[np.float64]

_SHARE = 0.5  # Of a leg that must have derivatives, without a break, up to its end.


class CostSensitivity:
    """Simulates a leg in closed loop over the prediction model and differentiates its cost by the weights.

    The references are those recorded when the leg was driven with the present weights; they do not follow the robot
    when the weights change, as the controller's do. So delays are made up for in the simulation that add up in a real
    leg, and the gradient is one of direction more than of size.
    """

    def __init__(self, simulator: LegSimulator, *, cost: LegCost, bedsides: Collection[str]) -> None:
        """Makes it.

        Args:
            simulator: of legs.
            cost: of a leg.
            bedsides: places to which legs have an approach error.
        """
        self._simulator = simulator
        self._cost = cost
        self._bedsides = frozenset(bedsides)

    def __call__(self, leg: DrivenLeg, *, prices: Sequence[float]) -> Vector:
        """D cost / d log of the diagonal entries of Q (with W's) and R, shape (9,), by the adjoint mode.

        The part of the leg after the last step without a derivative counts, if that is half of it or more.

        Args:
            leg: as it was driven.
            prices: of the five features, see `LegCost`.

        Raises:
            RuntimeError: the simulated leg does not succeed, or its cost has no derivative.
        """
        run = self._simulator(leg, _by_weights)
        tail, steps = run.tail, len(run.steps)
        if len(tail.steps) < _SHARE * steps:
            raise RuntimeError(f"has no derivative in the {steps - len(tail.steps)} first of {steps}")
        own = np.array(prices) * [1.0, 1.0, 1.0, 1.0, float(leg.action.place in self._bedsides)]
        cost = self._cost(tail.states, tail.controls, leg.target, own)
        return adjoint(tail, cost.by_end, cost.by_states, cost.by_controls).by_knobs


def _by_weights(leg: RecordedLeg, columns: Columns) -> ScheduledParameters:
    return weight_schedule(leg, np.zeros(WEIGHT_KNOBS), columns)
