"""Obstacles as the optimal control problem sees them: a fixed number of rounded, oriented rectangles.

The number of slots is fixed so that the problem is built once; a slot that is not needed holds a disc far away.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

from mala_drake.messages import Shape
from mala_drake.ward.shapes import ShapeDistances

_FAR_AWAY = 1e4  # Metres; beyond any ward, near enough to keep all digits.
_TINY = 1e-9  # Metres; keeps the derivative of the distance finite at a disc's centre.


class ObstacleIndex(IntEnum):
    """Layout of one obstacle slot."""

    X = 0
    Y = 1
    COSINE = 2
    SINE = 3
    HALF_LENGTH = 4
    HALF_WIDTH = 5
    RADIUS = 6


OBSTACLE_SIZE = len(ObstacleIndex)


def signed_distance(x: Any, y: Any, obstacle: Any) -> Any:
    """Distance in metres from a point to a rounded rectangle, negative inside; scalar CasADi expression.

    Exact everywhere, and continuously differentiable outside the core rectangle, that is up to a penetration by the
    rounding radius. Inside the core it is the depth below the nearest side, so that its gradient still points outward.

    Args:
        x: the point's x, metres.
        y: the point's y, metres.
        obstacle: one slot in the order of `ObstacleIndex`.
    """
    offset_x, offset_y = x - obstacle[ObstacleIndex.X], y - obstacle[ObstacleIndex.Y]
    cosine, sine = obstacle[ObstacleIndex.COSINE], obstacle[ObstacleIndex.SINE]
    along = casadi.fabs(cosine * offset_x + sine * offset_y) - obstacle[ObstacleIndex.HALF_LENGTH]
    across = casadi.fabs(cosine * offset_y - sine * offset_x) - obstacle[ObstacleIndex.HALF_WIDTH]
    beyond_along, beyond_across = casadi.fmax(along, 0), casadi.fmax(across, 0)
    outside = casadi.sqrt(beyond_along * beyond_along + beyond_across * beyond_across + _TINY**2)
    inside = casadi.fmin(casadi.fmax(along, across), 0)
    return outside + inside - obstacle[ObstacleIndex.RADIUS]


def pack_obstacles(shapes: Sequence[Shape], slots: int) -> NDArray[np.float64]:
    """The slots' values, shape (slots, 7), of at most `slots` shapes; unused slots hold a point far away."""
    packed = np.zeros((slots, OBSTACLE_SIZE))
    packed[:, ObstacleIndex.X] = _FAR_AWAY
    packed[:, ObstacleIndex.COSINE] = 1.0
    for slot, shape in zip(packed, shapes, strict=False):
        slot[:] = (
            shape.x,
            shape.y,
            np.cos(shape.yaw),
            np.sin(shape.yaw),
            shape.half_length,
            shape.half_width,
            shape.radius,
        )
    return packed


def nearest_shapes(shapes: Sequence[Shape], points: NDArray[np.float64], count: int) -> tuple[Shape, ...]:
    """The `count` shapes that come nearest to any of `points`, shape (n, 2), nearest first; ties keep their order."""
    if len(shapes) <= count:
        return tuple(shapes)
    distances = ShapeDistances(shapes)(points).min(axis=0)
    return tuple(shapes[i] for i in np.argsort(distances, kind="stable")[:count])
