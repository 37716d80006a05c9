"""Shortest collision-free routes over the ward's free space.

The free space is the floor less every solid shape grown by the robot's radius and a clearance; the shortest path in it
runs over vertices of the grown outlines (Lozano-Perez and Wesley 1979). The graph is made once per ward; start, goal
and what the robot finds in the way are added to it at each query.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from mala_drake.messages import Shape
from mala_drake.ward.shapes import outline

BODY_RADIUS = 0.28
"""Radius in metres of the disc that holds the robot's body, seen from above."""

ROUTE_CLEARANCE = 0.26
"""Metres kept between the body and anything solid along a route, where there is room."""

_TIGHT_CLEARANCE = 0.10  # What a route falls back to where the wide one does not exist.
GOAL_DISTANCE = BODY_RADIUS + _TIGHT_CLEARANCE + 0.01
"""Metres that a goal keeps from anything solid so as to have a route; outlines are circumscribed, hence a bit more."""

_NUDGE = 1e-3  # Vertices are moved this much outward, so that edges along an outline do not count as blocked.
_ESCAPE = 1.0  # Metres around a start that is too close to something, in which a free point is looked for.


@dataclass(frozen=True, slots=True)
class Route:
    """A polyline in the free space. `points` has shape (n, 2) with n >= 2, metres; not writeable."""

    points: NDArray[np.float64]

    @property
    def length(self) -> float:
        """Metres."""
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum())


class _FreeSpace:
    """A visibility graph at one clearance."""

    def __init__(self, shapes: Sequence[Shape], margin: float) -> None:
        self._solid = shapely.union_all([outline(shape, margin=margin) for shape in shapes])
        shapely.prepare(self._solid)
        self._bodies = np.array([outline(shape) for shape in shapes], dtype=object)
        grown = shapely.union_all([outline(shape, margin=margin + _NUDGE) for shape in shapes])
        corners = shapely.get_coordinates(grown)
        self._vertices = np.unique(corners[~shapely.contains_xy(self._solid, corners)], axis=0)
        self._distances = self._visible_among_vertices()

    def free(self, point: NDArray[np.float64]) -> bool:
        return not shapely.contains_xy(self._solid, *point)

    def nearest_free(self, point: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """The free point nearest to `point`, or None when there is none close by or it is behind something solid."""
        if self.free(point):
            return point
        way_out = shapely.shortest_line(shapely.Point(point), self._solid.boundary)
        step = shapely.get_coordinates(way_out)[1] - point
        distance = float(np.hypot(*step))
        if distance > _ESCAPE:
            return None
        escaped = point + step * (1 + 2 * _NUDGE / max(distance, 1e-9))
        return escaped if self.free(escaped) and not self._crosses(point, escaped) else None

    def _crosses(self, start: NDArray[np.float64], end: NDArray[np.float64]) -> bool:
        """Whether something solid is on the way; what `start` is in, as by an estimate that is off, may be left."""
        met = shapely.intersects(self._bodies, shapely.LineString([start, end]))
        return bool((met & ~shapely.contains_xy(self._bodies, *start)).any())

    def _visible_distances(self, a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
        """Lengths of the free segments between two sets of points; infinite where something is in the way."""
        segments = np.stack(np.broadcast_arrays(a[:, None, :], b[None, :, :]), axis=2)
        lengths = np.hypot(*(b[None, :, :] - a[:, None, :]).transpose(2, 0, 1))
        lines = shapely.linestrings(segments.reshape(-1, 2, 2))
        blocked = shapely.intersects(self._solid, lines).reshape(lengths.shape)
        return np.where(blocked, np.inf, lengths)

    def _visible_among_vertices(self) -> NDArray[np.float64]:
        n = len(self._vertices)
        distances = np.full((n, n), np.inf)
        for i in range(n - 1):
            distances[i, i + 1 :] = self._visible_distances(self._vertices[i : i + 1], self._vertices[i + 1 :])
        return np.minimum(distances, distances.T)

    def shortest(self, start: NDArray[np.float64], goal: NDArray[np.float64]) -> NDArray[np.float64] | None:
        ends = np.stack((start, goal))
        to_ends = self._visible_distances(self._vertices, ends)
        direct = self._visible_distances(start[None], goal[None])[0, 0]
        n = len(self._vertices)
        distance, previous = np.full(n + 1, np.inf), np.full(n + 1, -1)
        distance[:n] = to_ends[:, 0]
        distance[n] = direct
        queue = [(float(d), i) for i, d in enumerate(distance) if np.isfinite(d)]
        heapq.heapify(queue)
        while queue:
            so_far, node = heapq.heappop(queue)
            if so_far > distance[node]:
                continue
            if node == n:
                break
            onward = so_far + np.append(self._distances[node], to_ends[node, 1])
            for better in np.flatnonzero(onward < distance - 1e-9):
                distance[better], previous[better] = onward[better], node
                heapq.heappush(queue, (float(onward[better]), int(better)))
        if not np.isfinite(distance[n]):
            return None
        path, node = [goal], previous[n]
        while node >= 0:
            path.append(self._vertices[node])
            node = previous[node]
        return np.array([*path, start])[::-1]


class RoutePlanner:
    """Finds routes among a fixed set of shapes, and round additional ones that only a sensor has seen."""

    def __init__(self, shapes: Iterable[Shape], *, body_radius: float = BODY_RADIUS) -> None:
        """Builds the visibility graphs.

        Args:
            shapes: everything solid on the map.
            body_radius: of the robot, metres.
        """
        self._shapes = tuple(shapes)
        self._margins = (body_radius + ROUTE_CLEARANCE, body_radius + _TIGHT_CLEARANCE)
        self._spaces: dict[tuple[tuple[Shape, ...], float], _FreeSpace] = {}

    def _space(self, unmapped: tuple[Shape, ...], margin: float) -> _FreeSpace:
        key = (unmapped, margin)
        if key not in self._spaces:
            if len(self._spaces) > 8:  # Only the map's own graphs are worth keeping for long.
                self._spaces = {k: space for k, space in self._spaces.items() if not k[0]}
            self._spaces[key] = _FreeSpace((*self._shapes, *unmapped), margin)
        return self._spaces[key]

    def route(
        self,
        start: tuple[float, float],
        goal: tuple[float, float],
        *,
        unmapped: Iterable[Shape] = (),
    ) -> Route | None:
        """The shortest route, or None when nothing free leads to the goal.

        Prefers the wide clearance and falls back to the tight one. A start that is too close to something (after a
        bump, say) is first left by the shortest way; a goal that is not free has no route.
        """
        found = tuple(sorted(unmapped, key=lambda shape: (shape.name, shape.x, shape.y)))
        begin, end = np.array(start, dtype=float), np.array(goal, dtype=float)
        for margin in self._margins:
            space = self._space(found, margin)
            free_begin = space.nearest_free(begin)
            if free_begin is None or not space.free(end):
                continue
            points = space.shortest(free_begin, end)
            if points is not None:
                if free_begin is not begin:
                    points = np.vstack((begin, points))
                points.setflags(write=False)
                return Route(points)
        return None

    def segment_is_free(
        self, a: tuple[float, float], b: tuple[float, float], *, unmapped: Iterable[Shape] = ()
    ) -> bool:
        """Whether the straight segment keeps the wide clearance."""
        found = tuple(sorted(unmapped, key=lambda shape: (shape.name, shape.x, shape.y)))
        space = self._space(found, self._margins[0])
        ends = np.array([a, b], dtype=float)
        return bool(np.isfinite(space._visible_distances(ends[:1], ends[1:])[0, 0])) and space.free(ends[0])
