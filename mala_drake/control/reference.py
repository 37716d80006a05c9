"""From a drive path to the reference of one horizon: a virtual robot that drives the path as one should.

The virtual robot starts where the real one is on the path and with its speed and yaw, turns on the spot while it looks
the wrong way, else drives with the path's ceilings, and at the end turns to the target yaw. The reference thus never
runs away from the robot and never asks a differential drive to move sideways.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mala_drake.messages import Message
from mala_drake.ward.drive_path import ACCELERATION, DECELERATION, TURN_RATE, DrivePath

from .model import StateIndex
from .piecewise_linear import PiecewiseLinear

_TURN_FIRST = 0.5  # Radians of heading error beyond which a moving start turns on the spot first.
_ALIGNED = 0.12  # Radians within which such a turn is done.
_MARGIN = 0.92  # Share of the speed ceiling that the reference uses, so that the limit itself stays inactive.
_SEARCH_AHEAD = 60  # Samples of the path in which the robot is looked for.
_AT_REST = 1e-6  # Metres, radians, and those per second.
_REVERSE_SPEED = 0.3  # Metres per second at most when creeping back.


@dataclass(frozen=True, slots=True, eq=False)
class Reference(Message):
    """The reference of one horizon: states, shape (N + 1, 6), with unwrapped yaw."""

    states: NDArray[np.float64]

    def until_rest(self, shortest: int) -> Reference:
        """The reference up to where it comes to rest, in at least `shortest` stages; all of it if it does not.

        The horizon then shrinks by a stage a sample while the robot keeps to it, and ends with the leg.
        """
        away = np.flatnonzero(np.abs(self.states - self.states[-1]).max(axis=1) > _AT_REST)
        stages = max(shortest, away[-1] + 1 if len(away) else 0)
        at_rest = np.abs(self.states[-1, StateIndex.FORWARD_VELOCITY :]).max() <= _AT_REST
        return Reference(self.states[: stages + 1]) if at_rest else self


@dataclass(frozen=True, slots=True, eq=False)
class Track(Message):
    """A drive path with the yaw wanted at its end, driven forward or (short ways only) in reverse."""

    path: DrivePath
    target_yaw: float
    reverse: bool = False
    _x: PiecewiseLinear = field(init=False, repr=False)
    _y: PiecewiseLinear = field(init=False, repr=False)
    _heading: PiecewiseLinear = field(init=False, repr=False)
    _ceiling: PiecewiseLinear = field(init=False, repr=False)

    def __post_init__(self) -> None:
        path = self.path
        columns = {"x": path.points[:, 0], "y": path.points[:, 1], "heading": path.headings, "ceiling": path.ceilings}
        for name, values in columns.items():
            object.__setattr__(self, f"_{name}", PiecewiseLinear(path.lengths, values))

    @property
    def goal(self) -> tuple[float, float]:
        """The path's end, metres."""
        return float(self.path.points[-1, 0]), float(self.path.points[-1, 1])

    def position(self, length: float) -> tuple[float, float]:
        """The point of the path at arc length `length`, metres."""
        return self._x(length), self._y(length)

    def heading(self, length: float) -> float:
        """The robot's yaw wanted at arc length `length`."""
        heading = self._heading(length)
        return heading + math.pi if self.reverse else heading

    def ceiling(self, length: float) -> float:
        """The speed wanted at most at arc length `length`, metres per second, not negative."""
        speed = _MARGIN * self._ceiling(length)
        return min(speed, _REVERSE_SPEED) if self.reverse else speed

    def progress(self, position: NDArray[np.float64], previous: float) -> tuple[float, float]:
        """Arc length of the sample nearest to `position`, from the previous one on, and the distance to it in metres.

        It never falls: where a path turns back on itself, the robot that has begun to turn would else be taken back to
        before the turn, and so on for ever.
        """
        first = int(np.searchsorted(self.path.lengths, previous))
        window = self.path.points[first : first + _SEARCH_AHEAD]
        distances = np.hypot(*(window - position).T)
        nearest = int(np.argmin(distances))
        return float(self.path.lengths[first + nearest]), float(distances[nearest])


def make_reference(
    track: Track, state: NDArray[np.float64], length: float, *, turning: bool, horizon: int, period: float
) -> Reference:
    """Lets the virtual robot drive for one horizon.

    Args:
        track: what to follow.
        state: the robot's state z, shape (6,).
        length: arc length where the robot is on the path.
        turning: whether the robot is in a turn on the spot, which is to be completed.
        horizon: number of stages N.
        period: seconds a stage.
    """
    virtual = _Virtual(track, state, length, turning)
    rows = [virtual.state()]
    for _ in range(horizon):
        virtual.advance(period)
        rows.append(virtual.state())
    states = np.array(rows)
    states[1:, StateIndex.YAW_RATE] = np.diff(states[:, StateIndex.YAW]) / period
    return Reference(states)


def needs_turn(track: Track, yaw: float, length: float, *, turning: bool) -> bool:
    """Whether the robot looks so far away from the path that it turns on the spot, with hysteresis."""
    end = track.path.length
    return length < end and _looks_away(track.heading(length) - yaw, end, turning)


def _looks_away(error: float, end: float, turning: bool) -> bool:
    """The same short of the path's `end`, by the difference of the yaws."""
    # On a short way back to the target a small angle already misses it.
    wide = _TURN_FIRST if end > 1.0 else 2 * _ALIGNED
    return abs(math.remainder(error, math.tau)) > (_ALIGNED if turning else wide)


class _Virtual:
    def __init__(self, track: Track, state: NDArray[np.float64], length: float, turning: bool) -> None:
        self._track = track
        self._end = track.path.length
        self._length = length
        self._heading = track.heading(length)
        self._turning = turning
        forward = float(state[StateIndex.FORWARD_VELOCITY])
        self._yaw = float(state[StateIndex.YAW])
        self._speed = max(0.0, -forward if track.reverse else forward)
        self._yaw_rate = float(state[StateIndex.YAW_RATE])

    def state(self) -> tuple[float, float, float, float, float, float]:
        """Its state z, with the yaw rate that the robot begins with."""
        speed = -self._speed if self._track.reverse else self._speed
        return *self._track.position(self._length), self._yaw, speed, 0.0, self._yaw_rate

    def advance(self, period: float) -> None:
        away = self._heading - self._yaw
        self._turning = self._length < self._end and _looks_away(away, self._end, self._turning)
        at_end = self._length >= self._end - 1e-6
        ceiling = 0.0 if self._turning or at_end else self._ceiling_ahead(period)
        slowest, fastest = self._speed - DECELERATION * period, self._speed + ACCELERATION * period
        speed = max(0.0, min(max(ceiling, slowest), fastest))
        self._length = min(self._length + 0.5 * (self._speed + speed) * period, self._end)
        self._speed = speed
        self._heading = self._track.heading(self._length)
        wanted = self._track.target_yaw if at_end else self._heading
        step = TURN_RATE * period if self._turning or at_end else 2 * TURN_RATE * period
        error = math.remainder(wanted - self._yaw, math.tau)
        self._yaw += max(-step, min(step, error))

    def _ceiling_ahead(self, period: float) -> float:
        """The ceiling where this stage ends; just ahead at standstill, so that a path is also begun and finished."""
        ahead = self._length + max(self._speed * period, 0.02)
        return max(self._track.ceiling(ahead), min(0.1, (self._end - self._length) / period))
