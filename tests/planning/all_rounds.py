"""Every round of medicine that the ward allows for, listed by hand."""

from __future__ import annotations

import itertools

from .errands import CHARGERS, Errand, Legs, Walk

COLLECTING, CHECKING, DELIVERING = (5.2, 0.05), (2.2, 0.02), (20.2, 0.02)
"""Seconds, with those until the planner knows, and charge, by hand from the case's table."""


def all_rounds() -> list[Errand]:
    """Every feasible round with at most one recharge before each stop after the first, straight from the ward."""
    legs = Legs(("home", "pharmacy", "supply", "charger", "bedside"))

    def walked(stops: tuple[str, ...]) -> Errand | None:
        walk = Walk(legs)
        for stop in stops:
            walk.drive_to(stop)
            if stop in CHARGERS:
                walk.recharge()
            elif stop.startswith("patient"):
                walk.deliver(*DELIVERING)
            else:
                walk.work(*COLLECTING)
                walk.work(*CHECKING)
        return walk.errand("medication")

    found = []
    for pharmacy, supply, side in itertools.product(["north", "south"], "AB", ["left", "right"]):
        first, second = f"pharmacy_{pharmacy}", f"supply_{supply}"
        for one, two in ((first, second), (second, first)):
            for charging in itertools.product(((), *((charger,) for charger in CHARGERS)), repeat=2):
                found.append(walked((one, *charging[0], two, *charging[1], f"patient_bed_{side}")))
    return [each for each in found if each is not None]
