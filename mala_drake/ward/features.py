"""The five cost features and their scales: one definition for prediction and measurement.

f = (time, safety, battery, proximity, approach), 0 best and 1 worst. The planner predicts them as sums over actions;
the feature meter measures them on the executed trajectory with the same rates.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.messages import Shape
from mala_drake.preferences import CRITERIA
from mala_drake.ward.congestion import RISK_LENGTH, Congestion
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.shapes import ShapeDistances
from mala_drake.ward.ward_map import Ward

FEATURES = CRITERIA

COMFORT_RADIUS = 3.0
"""Metres round the bed within which the robot is felt as near."""

STANDING_DISCOMFORT = 0.25
"""Discomfort per second of a robot that stands at the bed's edge; driving adds its speed."""

IDEAL_HAND_OVER = (22.9, 11.4, -2.4)
"""Where the patient would like things to be handed over: metres and yaw, at the pillow's right, face to face.

No place is just there; the nearer a bedside is to it, in distance and direction, the better its approach.
"""


@dataclass(frozen=True)
class FeatureScales:
    """What counts as 1: seconds, risk, charge, discomfort, approach error. The defaults are those of `medication`."""

    time: float = 123.0
    safety: float = 0.225
    battery: float = 1.0
    proximity: float = 10.0
    approach: float = 1.25

    def as_array(self) -> NDArray[np.float64]:
        """The five scales in the order of `FEATURES`."""
        return np.array([self.time, self.safety, self.battery, self.proximity, self.approach])


FEATURE_SCALES: Mapping[str, FeatureScales] = MappingProxyType(
    {
        "medication": FeatureScales(),
        # A hot meal takes twice as long as a sandwich and more than one charge; a dish's looks add to the approach.
        "meal": FeatureScales(time=320.0, safety=0.49, battery=1.95, proximity=7.0, approach=1.9),
    }
)
"""By task: such that the features of the plans worth choosing lie between 0.3 and 0.95."""


class FeatureRates:
    """How fast features grow, by where the robot is and how fast it moves. Unscaled."""

    def __init__(self, ward: Ward, *, bed: str = "bed") -> None:
        """Looks at `ward`; `bed` names the furniture that the patient lies in."""
        self._congestion = Congestion(ward)
        shape = bed_shape(ward, bed)
        self._bed = None if shape is None else ShapeDistances([shape])

    def risk_rate(self, points: ArrayLike, speeds: ArrayLike) -> NDArray[np.float64]:
        """Risk per second at `points` (..., 2) and `speeds` (...), or one speed for all."""
        return self._congestion.level(points) * np.abs(np.asarray(speeds)) / RISK_LENGTH

    def discomfort_rate(self, points: ArrayLike, speeds: ArrayLike) -> NDArray[np.float64]:
        """Discomfort per second: closeness to the bed times (standing discomfort + speed)."""
        points = np.asarray(points, dtype=float)
        if self._bed is None:
            return np.zeros(points.shape[:-1])
        distance = self._bed(points)[..., 0]
        closeness = np.clip(1.0 - distance / COMFORT_RADIUS, 0.0, 1.0)
        return closeness * (STANDING_DISCOMFORT + np.abs(np.asarray(speeds)))


def bed_shape(ward: Ward, name: str = "bed") -> Shape | None:
    """The bed that the patient lies in, seen from above; None in a ward without one."""
    return next((piece.shape for piece in ward.furniture if piece.name == name), None)


def approach_error(pose: tuple[float, float, float], ideal: tuple[float, float, float]) -> float:
    """How far a hand-over pose (x, y, yaw) is from the patient's ideal one: half by distance, half by direction.

    4 m or half a turn away count as 1 each before halving; the value lies in [0, 1].
    """
    distance = min(math.dist(pose[:2], ideal[:2]) / 4.0, 1.0)
    turn = abs(math.remainder(pose[2] - ideal[2], math.tau)) / math.pi
    return 0.5 * distance + 0.5 * turn


def worst_approach_error(task: str) -> float:
    """The approach error of a task that has handed nothing over: the worst pose and, of a meal, the worst looks."""
    return 1.0 + (max(dish.presentation_error for dish in DISHES.values()) if task == "meal" else 0.0)
