"""Which ways each task knows: where its movements lead, and from where."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from mala_drake.ward.ward_map import Place, Ward

WAY_PREDICATES: Mapping[str, str] = {"medication": "open-way", "meal": "connected"}
"""What each task's domain calls a way between two locations that has not been found blocked."""

_TARGETS: Mapping[str, tuple[str, ...]] = {
    "medication": ("pharmacy", "supply", "charger", "bedside"),
    "meal": ("kitchen", "charger", "bedside"),
}
_STARTS = ("home",)  # Categories of places that a robot leaves but is never sent to.

# The way of a meal through the kitchen. Chargers can be reached from everywhere, and lead everywhere.
_MEAL_WAYS: Mapping[str, tuple[str, ...]] = {
    "home": ("pantry", "fridge"),
    "pantry": ("fridge", "prep_station"),
    "fridge": ("prep_station",),
    "prep_station": ("quality_check", "stove"),
    "stove": ("quality_check",),
    "quality_check": ("patient_bed_left", "patient_bed_right"),
}


def targets(ward: Ward, task: str) -> tuple[Place, ...]:
    """The places that a task's movements lead to, in the order of the map."""
    return tuple(place for place in ward.places if place.category in _TARGETS[task])


def ways(ward: Ward, task: str) -> Iterator[tuple[Place, Place]]:
    """The ways of a task between two places: start and goal, in the order of the map."""
    goals = targets(ward, task)
    for start in ward.places:
        if start.category not in _STARTS and start not in goals:
            continue
        for goal in goals:
            if start is not goal and _is_way(task, start, goal):
                yield start, goal


def _is_way(task: str, start: Place, goal: Place) -> bool:
    if task != "meal" or "charger" in (start.category, goal.category):
        return True
    return goal.name in _MEAL_WAYS.get(start.name, ())
