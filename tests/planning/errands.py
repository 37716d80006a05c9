"""Errands through the ward, added up by hand: ground truth that knows nothing of PDDL."""

from __future__ import annotations

import itertools
from collections.abc import Container, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mala_drake.patient.profiles import PROFILES
from mala_drake.planning.leg_costs import LegCosts
from mala_drake.ward.features import FEATURE_SCALES, IDEAL_HAND_OVER, approach_error
from mala_drake.ward.ward_map import LoadWard

CHARGERS = ("charge_main", "charge_backup")
TIME, RISK, CHARGE, DISCOMFORT, ERROR = range(5)


@dataclass(frozen=True)
class Errand:
    """One way to do a task without mistakes: the places visited, the unscaled sums, and the scaled features."""

    stops: tuple[str, ...]
    length: float
    sums: NDArray[np.float64]
    features: NDArray[np.float64]
    actions: int
    penalty: float  # For arriving with a low charge.
    dish: str

    @property
    def side(self) -> str:
        return self.stops[-1].removeprefix("patient_bed_")


class Legs:
    """All legs between places of some categories, and the charge to keep at each place for the way to a charger."""

    def __init__(self, categories: Container[str]) -> None:
        self.ward = LoadWard()
        self.costs = LegCosts(self.ward)
        places = [place.name for place in self.ward.places if place.category in categories]
        pairs = [(a, b) for a, b in itertools.permutations(places, 2) if b != "home"]
        self.between = {(a, b): self.costs.between(a, b) for a, b in pairs}
        self.reserve = {
            a: min(0.0 if a == charger else self.between[a, charger].charge for charger in CHARGERS)
            for a in places
            if a != "home"
        }


class Walk:
    """A robot on an errand: what it adds up, and whether a charger stays within reach."""

    def __init__(self, legs: Legs) -> None:
        self._legs = legs
        self._sums = np.zeros(5)
        self._charge, self._length, self._actions, self._penalty = 1.0, 0.0, 0, 0.0
        self._stops = ["home"]
        self._possible = True

    def drive_to(self, stop: str) -> None:
        leg = self._legs.between[self._stops[-1], stop]
        self._stops.append(stop)
        self._sums += (leg.time, leg.risk, leg.charge, leg.discomfort, 0.0)
        self._length, self._actions = self._length + leg.length, self._actions + 1
        self._use(leg.charge)
        self._penalty += 0.2 * (self._charge < 0.25) + 0.5 * (self._charge < 0.15)

    def work(self, seconds: float, charge: float) -> None:
        self._sums[[TIME, CHARGE]] += seconds, charge
        self._actions += 1
        self._use(charge)

    def deliver(self, seconds: float, charge: float, presentation_error: float = 0.0) -> None:
        place = self._legs.ward.place[self._stops[-1]]
        error = approach_error((place.x, place.y, place.yaw), IDEAL_HAND_OVER) + presentation_error
        self._sums[[DISCOMFORT, ERROR]] += self._legs.costs.standing_discomfort(place.name, seconds), error
        self.work(seconds, charge)

    def recharge(self) -> None:
        self._sums[TIME] += 30.2
        self._charge, self._actions = 1.0, self._actions + 1

    def errand(self, task: str, dish: str = "") -> Errand | None:
        """What it was in the end; None where the charge did not suffice."""
        if not self._possible:
            return None
        features = self._sums / FEATURE_SCALES[task].as_array()
        stops = tuple(self._stops[1:])
        return Errand(stops, self._length, self._sums, features, self._actions, self._penalty, dish)

    def _use(self, charge: float) -> None:
        self._charge -= charge
        self._possible &= self._charge >= self._legs.reserve.get(self._stops[-1], 0.0)


class Chooser:
    """The best of some errands at given weights."""

    def __init__(self, errands: Sequence[Errand]) -> None:
        self.errands = errands
        self._features = np.array([each.features for each in errands])
        self._steps = np.array([0.01 * each.actions for each in errands])
        self._penalties = np.array([each.penalty for each in errands])

    def costs(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """The metric of each, by hand: w' f, the penalty for low charges, the time once more, and 0.01 a step."""
        stage = self._features @ weights + weights[CHARGE] * self._penalties
        return stage + weights[TIME] * self._features[:, TIME] + self._steps

    def best(self, weights: NDArray[np.float64]) -> Errand:
        return self.errands[int(np.argmin(self.costs(weights)))]

    def of_profiles(self) -> dict[str, Errand]:
        """The best at the true weights of each profile."""
        return {name: self.best(np.array(weights)) for name, weights in PROFILES.items()}

    def nearly_best(self, weights: NDArray[np.float64], margin: float) -> list[Errand]:
        """All whose cost is less than this above the lowest."""
        costs = self.costs(weights)
        return [each for each, cost in zip(self.errands, costs, strict=True) if cost < costs.min() + margin]
