"""Where the penalties' curvature jumps: the optimal control problem is twice differentiable everywhere else.

A penalty's curvature jumps where its margin enters the buffer and where it is used up (`penalty.py`). The distance to a
rounded rectangle has a jump of curvature where a side ends and a corner begins. Braking into reverse counts by the size
of the brake. Points inside an obstacle's core rectangle, where the distance itself has ridges, are not looked at.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mala_drake.buffered_function import BufferedFunction, densified
from mala_drake.control.model import ControlIndex, StateIndex
from mala_drake.control.obstacles import ObstacleIndex
from mala_drake.control.shooting import LIMIT_BUFFER, OBSTACLE_BUFFER, limit_margins, obstacle_margins

from .kkt_point import KktPoint
from .stage_functions import StageFunctions

Vector = NDArray[np.float64]

_COUNTS = 0.01  # Of the weight of the forward velocity: a smaller jump of curvature is none.


class KinkDistances:
    """Measures how near a trajectory comes to a jump of curvature. Owns work arrays."""

    def __init__(self, functions: StageFunctions) -> None:
        self._data = functions.data
        self._obstacles = functions.data.sources[0, functions.data.slices["constraints.obstacles"]]
        pieces = self._data.pieces(functions.numbers)
        margins = [obstacle_margins(functions.reached, pieces), limit_margins(functions.reached, 0, pieces)]
        stage = densified("margins", [functions.reached, functions.numbers], margins)
        self._margins = BufferedFunction(stage.map(functions.horizon))

    def nearest(self, point: KktPoint) -> float:
        """The smallest distance, in the unit of the margin it is of; infinite where no penalty can matter."""
        reached = point.states[1:]
        self._margins.arguments[0][:] = reached.T
        self._margins.arguments[1][:] = point.packed[self._data.sources].T
        self._margins()
        to_obstacles, to_limits = (result.T for result in self._margins.results)
        forward = reached[:, StateIndex.FORWARD_VELOCITY]
        constraints = point.parameters.constraints
        jump = constraints.reverse_braking_penalty * point.controls[:, ControlIndex.BRAKE] / LIMIT_BUFFER
        least = _COUNTS * point.parameters.stage.state_weights[StateIndex.FORWARD_VELOCITY]
        return min(
            _to_edge(to_obstacles, OBSTACLE_BUFFER),
            _to_edge(to_limits, LIMIT_BUFFER),
            _to_edge(forward[jump > least] + LIMIT_BUFFER, LIMIT_BUFFER),
            self._to_corner(point, to_obstacles < OBSTACLE_BUFFER),
        )

    def _to_corner(self, point: KktPoint, active: NDArray[np.bool_]) -> float:
        """The smallest distance along a side of an obstacle that counts to where that side ends."""
        slots = point.packed[self._obstacles].reshape(1, -1, len(ObstacleIndex))
        offset = point.states[1:, None, [StateIndex.X, StateIndex.Y]] - slots[..., [ObstacleIndex.X, ObstacleIndex.Y]]
        cosine, sine = slots[..., ObstacleIndex.COSINE], slots[..., ObstacleIndex.SINE]
        along = np.abs(cosine * offset[..., 0] + sine * offset[..., 1]) - slots[..., ObstacleIndex.HALF_LENGTH]
        across = np.abs(cosine * offset[..., 1] - sine * offset[..., 0]) - slots[..., ObstacleIndex.HALF_WIDTH]
        # A disc has no sides.
        sides = active & (slots[..., ObstacleIndex.HALF_LENGTH] + slots[..., ObstacleIndex.HALF_WIDTH] > 0)
        return float(np.minimum(np.abs(along), np.abs(across))[sides].min(initial=np.inf))


def _to_edge(margins: Vector, buffer: float) -> float:
    return float(np.minimum(np.abs(margins), np.abs(margins - buffer)).min(initial=np.inf))
