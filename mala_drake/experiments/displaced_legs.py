"""What is kept of the legs to places that are not where the map says."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from mala_drake.messages import Action, ActionReport, LearnedTargets, PlaceMismatch
from mala_drake.scenario import Scenario
from mala_drake.ward.ward_map import Place


class DisplacedLegs:
    """Collects one entry a leg to a displaced place, and one an action there whose things are out of reach.

    An entry is fit for JSON: `place`, `outcome`, `mismatch` (1 - mu of the expected atom at the end, the continuous
    E^psi: of being at the place for a leg, of having its things within reach otherwise), `closed_loop_cost` (R^o, the
    leg's tracking and terminal cost), `moved` (whether the target was moved after it), and where the target is then:
    `x`, `y` and `distance_to_true_m`, metres.

    `sensitivity` is what the target was moved through (see `SensitivitySource`; null where it was not moved), and
    `sensitivity_deviation` is |S - I|_2 of the S that was simulated for it, used or not (null where none was). Earlier
    versions have not written these two.
    """

    def __init__(self, scenario: Scenario, learned: LearnedTargets) -> None:
        """Knows where the places of a scenario are and where the map has them, and what is `learned` at the start."""
        self._updates = learned.updates
        self.entries: list[dict[str, Any]] = []
        self._mapped: Mapping[str, Place] = {}
        self._true: Mapping[str, Place] = {}
        if not (scenario.world.displaced_places or scenario.world.randomly_displaced):
            return
        ward = scenario.load_ward()
        displacements = scenario.displacements(ward)
        self._mapped = {name: ward.place[name] for name in displacements}
        self._true = {name: scenario.true_ward(ward).place[name] for name in displacements}

    def add(self, action: Action, report: ActionReport, mismatch: PlaceMismatch, learned: LearnedTargets) -> None:
        """Takes in a leg, or an action out of reach, that has ended, if it was at a displaced place.

        Args:
            action: that has ended.
            report: on its end.
            mismatch: at its end.
            learned: after it.
        """
        name = action.place
        if name not in self._true or mismatch.place != name:
            return
        mapped, true = self._mapped[name], self._true[name]
        moved = learned.updates > self._updates
        x, y = next(((x, y) for place, x, y in learned.targets if place == name), (mapped.x, mapped.y))
        self.entries.append(
            {
                "place": name,
                "outcome": report.outcome.value,
                "mismatch": mismatch.error,
                "closed_loop_cost": report.closed_loop_cost,
                "moved": moved,
                "x": x,
                "y": y,
                "distance_to_true_m": math.dist((x, y), (true.x, true.y)),
                "sensitivity": learned.sensitivity.value if moved else None,
                "sensitivity_deviation": learned.deviation if moved else None,
            }
        )
        self._updates = learned.updates
