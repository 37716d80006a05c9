"""Where each parameter group lies in the one vector p that the compiled expressions take."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .model import CONTROL_SIZE, DYNAMICS_SIZE, STATE_SIZE, StateIndex
from .obstacles import OBSTACLE_SIZE, nearest_shapes, pack_obstacles
from .parameters import MpcParameters

_FULL_TURN = 2 * np.pi


@dataclass(frozen=True)
class ParameterLayout:
    """Names, order and shapes of the pieces of p for a horizon of N stages and M obstacle slots.

    The pieces are stored one after another, matrices row by row. The input set p^a is not among them: it bounds the
    decision variables directly.
    """

    horizon: int
    slots: int

    @cached_property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Piece name to shape, in storage order."""
        return {
            "terminal.target": (STATE_SIZE,),
            "terminal.weights": (STATE_SIZE,),
            "stage.references": (self.horizon, STATE_SIZE),
            "stage.state_weights": (STATE_SIZE,),
            "stage.control_weights": (CONTROL_SIZE,),
            "dynamics": (DYNAMICS_SIZE,),
            "constraints.speed_limits": (self.horizon,),
            "constraints.reverse_limit": (),
            "constraints.yaw_rate_limit": (),
            "constraints.lateral_limit": (),
            "constraints.required_distance": (),
            "constraints.obstacle_penalty": (),
            "constraints.limit_penalty": (),
            "constraints.reverse_braking_penalty": (),
            "constraints.obstacles": (self.slots, OBSTACLE_SIZE),
        }

    @cached_property
    def slices(self) -> dict[str, slice]:
        """Piece name to its place in p."""
        places: dict[str, slice] = {}
        start = 0
        for name, shape in self.shapes.items():
            size = int(np.prod(shape))
            places[name] = slice(start, start + size)
            start += size
        return places

    @cached_property
    def size(self) -> int:
        """Length of p."""
        return sum(int(np.prod(shape)) for shape in self.shapes.values())

    def split(self, vector: Any, reshape: Callable[[Any, tuple[int, ...]], Any]) -> dict[str, Any]:
        """The pieces of a parameter vector (numbers or symbols), each passed through `reshape(piece, shape)`."""
        shapes = self.shapes
        return {name: reshape(vector[place], shapes[name]) for name, place in self.slices.items()}

    def pack(self, initial_state: NDArray[np.float64], parameters: MpcParameters) -> NDArray[np.float64]:
        """p, shape (size,), for a solve that starts from `initial_state`, shape (6,).

        The yaw references are unwrapped: the first one to within half a turn of the present yaw, each later one to
        within half a turn of the one before it. The plain difference in the cost then is the wrapped error, and the
        solver sees a smooth function. Of the obstacles those nearest to the references and the present position count.
        """
        stage, constraints = parameters.stage, parameters.constraints
        trajectory = np.vstack((initial_state, stage.references, parameters.terminal.target))
        yaw = _unwrapped(trajectory[:, StateIndex.YAW])
        references, target = stage.references.copy(), parameters.terminal.target.copy()
        references[:, StateIndex.YAW] = yaw[1:-1]
        target[StateIndex.YAW] = yaw[-1]
        positions = trajectory[:, [StateIndex.X, StateIndex.Y]]
        obstacles = nearest_shapes(constraints.obstacles, positions, self.slots)
        packed = np.empty(self.size)
        for name, piece in (
            ("terminal.target", target),
            ("terminal.weights", parameters.terminal.weights),
            ("stage.references", references.ravel()),
            ("stage.state_weights", stage.state_weights),
            ("stage.control_weights", stage.control_weights),
            ("dynamics", parameters.dynamics.vector),
            ("constraints.speed_limits", constraints.speed_limits),
            ("constraints.reverse_limit", constraints.reverse_limit),
            ("constraints.yaw_rate_limit", constraints.yaw_rate_limit),
            ("constraints.lateral_limit", constraints.lateral_limit),
            ("constraints.required_distance", constraints.robot_radius + constraints.clearance),
            ("constraints.obstacle_penalty", constraints.obstacle_penalty),
            ("constraints.limit_penalty", constraints.limit_penalty),
            ("constraints.reverse_braking_penalty", constraints.reverse_braking_penalty),
            ("constraints.obstacles", pack_obstacles(obstacles, self.slots).ravel()),
        ):
            packed[self.slices[name]] = piece
        return packed


def _unwrapped(yaw: NDArray[np.float64]) -> NDArray[np.float64]:
    """`np.unwrap` without its dispatch overhead: a quarter of the cost of packing."""
    return yaw - _FULL_TURN * np.concatenate(([0.0], np.cumsum(np.round(np.diff(yaw) / _FULL_TURN))))
