"""A route made drivable: rounded corners and a speed along the way.

Both the controller's reference and the planner's predictions (time, discomfort) come from this one profile.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mala_drake.ward.congestion import CRUISE_SPEED, Congestion
from mala_drake.ward.routes import Route

SPACING = 0.05
"""Metres between samples of a drive path."""

ACCELERATION = 0.8
"""Metres per second squared to speed up along a path."""

DECELERATION = 0.7
"""Metres per second squared to slow down along a path; a braking robot keeps some of its 2 m/s^2 in reserve."""

TURN_RATE = 0.9
"""Radians per second that curves and turns on the spot are driven with."""

_CORNER_CUT = 0.06  # Metres that a rounded corner may leave its vertex, towards the obstacle it goes round.
_TANGENT = 0.6  # Metres at most that the rounding takes from each side of a corner.
_CREEP = 0.15  # Metres per second at the sharpest corner, so that the profile never stands still on its way.


@dataclass(frozen=True, slots=True)
class DrivePath:
    """Samples along a leg, all of length n and not writeable, in metres, radians and seconds.

    Attributes:
        lengths: arc length from the start.
        points: shape (n, 2).
        headings: unwrapped direction of travel.
        ceilings: the highest speeds from which zones, curves and the stop at the end can still be met.
        speeds: the same when the robot starts from rest.
        times: since that start.
    """

    lengths: NDArray[np.float64]
    points: NDArray[np.float64]
    headings: NDArray[np.float64]
    ceilings: NDArray[np.float64]
    speeds: NDArray[np.float64]
    times: NDArray[np.float64]

    @property
    def length(self) -> float:
        """Metres."""
        return float(self.lengths[-1])

    @property
    def duration(self) -> float:
        """Seconds from standing at the start to standing at the end, without turns on the spot."""
        return float(self.times[-1])


def make_drive_path(route: Route, congestion: Congestion, *, cruise_speed: float = CRUISE_SPEED) -> DrivePath:
    """Rounds the corners of `route` and gives each point the highest speed that zones, curves and braking allow."""
    points = _resample(_round_corners(route.points))
    steps = np.diff(points, axis=0)
    lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*steps.T))))
    directions = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
    headings = np.append(directions, directions[-1])
    limits = np.minimum(congestion.speed_limit(points), cruise_speed)
    ceilings = _decelerate(np.minimum(limits, _curve_speeds(headings, lengths)), lengths)
    speeds = _accelerate(ceilings, lengths)
    # Between two samples the speed changes at constant acceleration, so its mean is the arithmetic one.
    times = np.concatenate(([0.0], np.cumsum(2 * np.diff(lengths) / np.maximum(speeds[1:] + speeds[:-1], 1e-3))))
    for array in (lengths, points, headings, ceilings, speeds, times):
        array.setflags(write=False)
    return DrivePath(lengths, points, headings, ceilings, speeds, times)


def _round_corners(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Replaces each corner by an arc that leaves it by no more than `_CORNER_CUT`."""
    points = points[np.append(True, np.hypot(*np.diff(points, axis=0).T) > 1e-9)]  # A repeated corner has no angle.
    rounded = [points[:1]]
    for before, corner, after in zip(points[:-2], points[1:-1], points[2:], strict=True):
        inward, outward = corner - before, after - corner
        room = 0.5 * min(np.hypot(*inward), np.hypot(*outward))
        u, v = inward / np.hypot(*inward), outward / np.hypot(*outward)
        angle = float(np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v))
        if abs(angle) < 1e-3:
            rounded.append(corner[None])
            continue
        tangent = min(_TANGENT, room, _CORNER_CUT / abs(np.tan(angle / 4)))
        radius = tangent / np.tan(abs(angle) / 2)
        side = np.sign(angle) * np.array([-u[1], u[0]])
        center = corner - tangent * u + radius * side
        turns = np.linspace(0.0, angle, max(3, int(np.ceil(abs(angle) / 0.15)) + 1))
        spoke = -radius * side
        cosines, sines = np.cos(turns), np.sin(turns)
        rounded.append(
            center + np.stack((cosines * spoke[0] - sines * spoke[1], sines * spoke[0] + cosines * spoke[1]), 1)
        )
    rounded.append(points[-1:])
    return np.concatenate(rounded)


def _resample(points: NDArray[np.float64]) -> NDArray[np.float64]:
    lengths = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    distinct = np.concatenate(([True], np.diff(lengths) > 1e-9))
    points, lengths = points[distinct], lengths[distinct]
    at = np.linspace(0.0, lengths[-1], max(2, int(np.ceil(lengths[-1] / SPACING)) + 1))
    return np.stack((np.interp(at, lengths, points[:, 0]), np.interp(at, lengths, points[:, 1])), axis=1)


def _curve_speeds(headings: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Speeds at which the curves are driven with `TURN_RATE`, the curvature taken over a short stretch."""
    window = 3  # Samples to each side: shorter than any arc that matters, longer than the sampling noise.
    i = np.arange(len(headings))
    a, b = np.maximum(i - window, 0), np.minimum(i + window, len(headings) - 1)
    curvature = np.abs(headings[b] - headings[a]) / np.maximum(lengths[b] - lengths[a], 1e-9)
    return np.maximum(TURN_RATE / np.maximum(curvature, 1e-9), _CREEP)


def _decelerate(limits: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """The highest speeds under `limits` from which one can brake to each later limit and to rest at the end."""
    speeds = limits.copy()
    speeds[-1] = 0.0
    for i, gap in reversed(list(enumerate(np.diff(lengths)))):
        speeds[i] = min(speeds[i], np.sqrt(speeds[i + 1] ** 2 + 2 * DECELERATION * gap))
    return speeds


def _accelerate(ceilings: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """The highest speeds under `ceilings` of a robot that starts from rest."""
    speeds = ceilings.copy()
    speeds[0] = 0.0
    for i, gap in enumerate(np.diff(lengths)):
        speeds[i + 1] = min(speeds[i + 1], np.sqrt(speeds[i] ** 2 + 2 * ACCELERATION * gap))
    return speeds
