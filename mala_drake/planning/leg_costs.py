"""What a leg will cost: predictions of time, risk, charge and discomfort from the ward's own drive paths.

The same path and speed profile is the controller's reference, and the same rates are measured on the executed
trajectory, so that prediction and measurement differ only by what really happens on the way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mala_drake.ward.congestion import Congestion
from mala_drake.ward.drive_path import TURN_RATE, DrivePath, make_drive_path
from mala_drake.ward.features import FeatureRates
from mala_drake.ward.legs import leg_planner
from mala_drake.ward.routes import Route
from mala_drake.ward.ward_map import Place, Ward

Pose = tuple[float, float, float]
"""x, y in metres and yaw in radians."""


@dataclass(frozen=True, slots=True)
class LegCalibration:
    """What a leg costs beyond its drive path.

    The constants come from legs driven in closed loop, 3 m to 29 m long: with them time is predicted within 0.8 s and
    charge within 0.004 (root mean square). At cruise a metre costs 0.0094 of the charge.
    """

    turn_rate: float = TURN_RATE  # Radians per second of the turns on the spot at both ends.
    settling_time: float = 2.2  # Seconds to stop at the pose, beyond the drive path's own, until the planner knows it.
    charge_per_metre: float = 0.0020  # However slowly it is driven.
    charge_per_metre_and_speed: float = 0.0049  # Friction grows with the speed: for each metre times m/s.
    charge_per_radian: float = 0.0029  # Of the turns on the spot.

    def charge(self, path: DrivePath, turned: float) -> float:
        """The state of charge that a leg along `path` uses, with turns on the spot by `turned` radians in all."""
        driven = float(np.trapezoid(path.speeds, path.lengths))
        return (
            self.charge_per_metre * path.length
            + self.charge_per_metre_and_speed * driven
            + self.charge_per_radian * turned
        )


@dataclass(frozen=True, slots=True)
class LegCost:
    """Unscaled predictions for one leg: metres, seconds, risk, state of charge used, discomfort."""

    length: float
    time: float
    risk: float
    charge: float
    discomfort: float


NO_COST = LegCost(length=0.0, time=0.0, risk=0.0, charge=0.0, discomfort=0.0)


class LegCosts:
    """Predicts legs on one ward."""

    def __init__(self, ward: Ward, *, calibration: LegCalibration | None = None) -> None:
        """Looks at `ward`; `calibration` has the constants of this robot by default."""
        self._ward = ward
        self._calibration = calibration or LegCalibration()
        self._congestion = Congestion(ward)
        self._rates = FeatureRates(ward)
        self._known: dict[tuple[str, str], LegCost | None] = {}

    def between(self, start: str, goal: str) -> LegCost | None:
        """The leg between two named places of the map, or None when there is no way."""
        if (start, goal) not in self._known:
            self._known[start, goal] = self.from_pose(_pose(self._ward.place[start]), goal)
        return self._known[start, goal]

    def from_pose(self, start: Pose, goal: str) -> LegCost | None:
        """The leg from any pose to a named place, or None when there is no way."""
        end = _pose(self._ward.place[goal])
        route = leg_planner(self._ward).to_pose(start[:2], end)
        if route is None:
            return None
        return self._predict(start, route, end)

    def standing_discomfort(self, place: str, seconds: float) -> float:
        """Discomfort of a robot that stands at a place for some seconds."""
        pose = _pose(self._ward.place[place])
        return seconds * float(self._rates.discomfort_rate(pose[:2], 0.0))

    def _predict(self, start: Pose, route: Route, end: Pose) -> LegCost:
        constants = self._calibration
        path = make_drive_path(route, self._congestion)
        turns = _turn(start[2], float(path.headings[0])), _turn(float(path.headings[-1]), end[2])
        before, after = turns[0] / constants.turn_rate, turns[1] / constants.turn_rate + constants.settling_time
        standing = self._rates.discomfort_rate([start[:2], end[:2]], [0.0, 0.0]) @ np.array([before, after])
        return LegCost(
            length=path.length,
            time=before + path.duration + after,
            risk=self._congestion.risk(path.points),
            charge=constants.charge(path, sum(turns)),
            discomfort=self._driving_discomfort(path) + float(standing),
        )

    def _driving_discomfort(self, path: DrivePath) -> float:
        middles, speeds = 0.5 * (path.points[1:] + path.points[:-1]), 0.5 * (path.speeds[1:] + path.speeds[:-1])
        return float(self._rates.discomfort_rate(middles, speeds) @ np.diff(path.times))


def _pose(place: Place) -> Pose:
    return (place.x, place.y, place.yaw)


def _turn(start: float, end: float) -> float:
    """Radians between two yaws, the shorter way."""
    return abs(math.remainder(end - start, math.tau))
