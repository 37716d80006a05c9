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
        self._centers_x = np.array([s.x for s in shapes])
        self._centers_y = np.array([s.y for s in shapes])
        self._cosines = np.array([np.cos(s.yaw) for s in shapes])
        self._sines = np.array([np.sin(s.yaw) for s in shapes])
        self._half_lengths = np.array([s.half_length for s in shapes])
        self._half_widths = np.array([s.half_width for s in shapes])
        self._radii = np.array([s.radius for s in shapes])

    def __call__(self, points: ArrayLike) -> NDArray[np.float64]:
        """Signed distances in metres, shape (..., number of shapes), of `points` with shape (..., 2)."""
        points = np.asarray(points, dtype=float)[..., None, :]
        dx, dy = points[..., 0] - self._centers_x, points[..., 1] - self._centers_y
        along = np.abs(self._cosines * dx + self._sines * dy) - self._half_lengths
        across = np.abs(self._cosines * dy - self._sines * dx) - self._half_widths
        outside = np.hypot(np.maximum(along, 0.0), np.maximum(across, 0.0))
        return outside + np.minimum(np.maximum(along, across), 0.0) - self._radii
