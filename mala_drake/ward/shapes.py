"""Plan-view geometry of a `messages.Shape`: outline, distance, and line of sight."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from mala_drake.messages import Shape

_ARC_SEGMENTS = 4  # Chords per quarter circle of an outline.


def outline(shape: Shape, *, margin: float = 0.0) -> shapely.Polygon:
    """The shape grown by `margin` metres; rounded corners are circumscribed polygons, so nothing is cut off."""
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * (shape.half_length, shape.half_width)
    cosine, sine = np.cos(shape.yaw), np.sin(shape.yaw)
    corners = corners @ np.array([[cosine, sine], [-sine, cosine]]) + (shape.x, shape.y)
    core = shapely.MultiPoint(corners).convex_hull
    reach = shape.radius + margin
    if reach <= 0:
        return core
    # A chord's middle lies cos(pi / (4 n)) inside its circle: grow by that so that the chords touch it from outside.
    return core.buffer(reach / np.cos(np.pi / (4 * _ARC_SEGMENTS)), quad_segs=_ARC_SEGMENTS)


class ShapeDistances:
    """Exact distances from points to many shapes at once.

    The distance to a rounded rectangle is that to its core rectangle less the rounding radius; it is negative inside.
    """

    def __init__(self, shapes: Sequence[Shape]) -> None:
        self._centers = np.array([[s.x, s.y] for s in shapes]).reshape(-1, 2)
        self._cosines = np.array([np.cos(s.yaw) for s in shapes])
        self._sines = np.array([np.sin(s.yaw) for s in shapes])
        self._half_sizes = np.array([[s.half_length, s.half_width] for s in shapes]).reshape(-1, 2)
        self._radii = np.array([s.radius for s in shapes])

    def __call__(self, points: ArrayLike) -> NDArray[np.float64]:
        """Signed distances in metres, shape (..., number of shapes), of `points` with shape (..., 2)."""
        offset = np.asarray(points, dtype=float)[..., None, :] - self._centers
        along = self._cosines * offset[..., 0] + self._sines * offset[..., 1]
        across = -self._sines * offset[..., 0] + self._cosines * offset[..., 1]
        outside = np.abs(np.stack((along, across), axis=-1)) - self._half_sizes
        beyond = np.maximum(outside, 0.0)
        return np.hypot(beyond[..., 0], beyond[..., 1]) + np.minimum(outside.max(axis=-1), 0.0) - self._radii
