"""Every way to prepare and serve a dish that the ward allows for, listed by hand."""

from __future__ import annotations

import itertools

from mala_drake.ward.dishes import DISHES

from .errands import CHARGERS, Errand, Legs, Walk

# Seconds, with those until the planner knows, and charge of what is done at each place, by hand from the case's table.
CHOOSING, COLLECTING, SERVING = (0.8, 0.0), (5.2, 0.02), (10.2, 0.01)
AT_PREP_STATION = ((4.2, 0.01), (5.2, 0.02), (6.2, 0.02), (8.2, 0.03))
AT_STOVE = ((12.2, 0.5), (4.2, 0.01))

COLD = ("pantry", "prep_station", "quality_check")
HOT = ("pantry", "fridge", "prep_station", "stove", "quality_check")
ROUTES = {"sandwich": COLD, "salad": COLD, "hot_meal": HOT}


def work_at(stop: str, dish: str) -> tuple[tuple[float, float], ...]:
    """Seconds and charge of each action at a stop before the bedside."""
    kept = {"pantry": 1 if dish == "hot_meal" else 2, "fridge": 1}
    quality = ((4.2, 0.01), ({"salad": 13.6}.get(dish, 5.2), 0.02))
    done = {"prep_station": AT_PREP_STATION, "stove": AT_STOVE, "quality_check": quality}
    return done.get(stop, (COLLECTING,) * kept.get(stop, 0))


def all_meals() -> list[Errand]:
    """Every feasible way to a dish with at most two visits to chargers, to recharge or in passing, from the ward."""
    legs = Legs(("home", "kitchen", "charger", "bedside"))

    def walked(dish: str, stops: tuple[str, ...], charging: tuple[bool, ...]) -> Errand | None:
        walk, recharges = Walk(legs), iter(charging)
        walk.work(*CHOOSING)
        for stop in stops:
            walk.drive_to(stop)
            if stop in CHARGERS and next(recharges):
                walk.recharge()
            for seconds, charge in work_at(stop, dish):
                walk.work(seconds, charge)
            if stop.startswith("patient"):
                walk.deliver(*SERVING, DISHES[dish].presentation_error)
        return walk.errand("meal", dish)

    found = []
    for (dish, route), side in itertools.product(ROUTES.items(), ("left", "right")):
        places = (*route, f"patient_bed_{side}")
        for chargers in itertools.product((None, *CHARGERS), repeat=len(places)):
            visits = sum(charger is not None for charger in chargers)
            if visits > 2:
                continue
            stops = tuple(s for pair in zip(chargers, places, strict=True) for s in pair if s is not None)
            for charging in itertools.product((False, True), repeat=visits):
                found.append(walked(dish, stops, charging))
    return [each for each in found if each is not None]
