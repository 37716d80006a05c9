"""The numbers of a care problem, predicted from the ward: what each leg and each action at a place will cost.

Numbers are unscaled and rounded to few decimals; the same functions write the problem file and predict the legs of a
robot that is found between the named places. Locations of the planning domain are the places of the map in lower case,
as PDDL does not tell cases apart.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from decimal import Decimal
from pathlib import Path

from mala_drake.clock import ROUNDING, TICK
from mala_drake.errors import BadInput
from mala_drake.planning.leg_costs import LegCost, LegCosts
from mala_drake.planning.ways import WAY_PREDICATES, targets, ways
from mala_drake.ward.cost_parameters import (
    APPROACH_ERROR,
    LEG_RESERVE,
    STANDING_DISCOMFORT,
    charge_name,
    location_name,
    time_name,
)
from mala_drake.ward.dishes import DISHES
from mala_drake.ward.features import FEATURE_SCALES, IDEAL_HAND_OVER, approach_error
from mala_drake.ward.in_place_actions import VERBS, InPlaceAction, Verb
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import Ward

IN_TRANSIT = "in_transit"
"""The location of a robot that is at no named place."""

Fact = tuple[str, ...]
Fluents = dict[Fact, Decimal]

STOCK_PREDICATES: Mapping[str, str] = {"medication": "available", "meal": "ingredient_available"}
"""What each task's domain calls a thing that is in stock at a location."""

_UNITS = ("second", "risk", "charge", "discomfort", "error")  # Of the unscaled features, in their order.
_BEGIN = ";; BEGIN generated"
_END = ";; END generated"


def leg_fluents(cost: LegCost, start: str, goal: str) -> Fluents:
    """What the domain wants to know of a leg between two of its locations."""
    return {
        ("nav-time", start, goal): _rounded(cost.time, 2),
        ("location-safety", start, goal): _rounded(cost.risk, 5),
        ("nav-charge", start, goal): _rounded(cost.charge, 4),
        **leg_reserve(cost.charge, start, goal),  # Nothing better is known before a leg is driven.
        ("proximity-feature", start, goal): _rounded(cost.discomfort, 3),
    }


def leg_reserve(charge: float, start: str, goal: str) -> Fluents:
    """The charge to count on for a leg."""
    return {(LEG_RESERVE, start, goal): _rounded(charge, 4)}


def leg_data(costs: LegCosts, ward: Ward, task: str) -> tuple[tuple[Fact, ...], Fluents]:
    """The open ways of a task, and the numbers of each."""
    predicate = WAY_PREDICATES[task]
    open_ways: list[Fact] = []
    fluents: Fluents = {}
    for start, goal in ways(ward, task):
        cost = costs.between(start.name, goal.name)
        if cost is not None:
            pair = location_name(start.name), location_name(goal.name)
            open_ways.append((predicate, *pair))
            fluents |= leg_fluents(cost, *pair)
    open_ways += [(predicate, IN_TRANSIT, location_name(goal.name)) for goal in targets(ward, task)]
    return tuple(open_ways), fluents


def place_fluents(costs: LegCosts, ward: Ward, task: str, legs: Fluents) -> Fluents:
    """The numbers of single places; `legs` are those of `leg_data`.

    Raises:
        BadInput: if no charger can be reached from a place.
    """
    goals = targets(ward, task)
    chargers = [location_name(place.name) for place in goals if place.category == "charger"]
    fluents: Fluents = {}
    for goal in goals:
        name = location_name(goal.name)
        needed = [
            Decimal(0) if name == charger else legs[(LEG_RESERVE, name, charger)]
            for charger in chargers
            if name == charger or (LEG_RESERVE, name, charger) in legs
        ]
        if not needed:
            raise BadInput(f"ward {ward.name}", f"no way from {goal.name} to a charger", "at least one")
        fluents[("nearest-charger-battery", name)] = min(needed)
    for goal in goals:
        if goal.category == "bedside":
            name = location_name(goal.name)
            error = approach_error((goal.x, goal.y, goal.yaw), IDEAL_HAND_OVER)
            fluents[(APPROACH_ERROR, name)] = _rounded(error, 4)
            fluents[(STANDING_DISCOMFORT, name)] = _rounded(costs.standing_discomfort(goal.name, 1.0), 4)
    return fluents


def table_fluents(task: str) -> Fluents:
    """What actions at a place take, and how much of a scaled feature one unit is."""
    fluents: Fluents = {}
    for verb in VERBS[task]:
        for dish in DISHES if verb is Verb.ASSEMBLE else ("",):
            action = InPlaceAction(verb, dish=dish)
            about = (dish,) if dish else ()
            fluents[(time_name(verb), *about)] = _rounded(_until_known(action.seconds), 2)
            if verb is not Verb.RECHARGE:
                fluents[(charge_name(verb), *about)] = _rounded(action.charge, 4)
    if task == "meal":
        fluents |= {("presentation-error", d.name): _rounded(d.presentation_error, 4) for d in DISHES.values()}
    for unit, scale in zip(_UNITS, FEATURE_SCALES[task].as_array(), strict=True):
        fluents[(f"feature-per-{unit}",)] = _rounded(1.0 / scale, 6)
    return fluents


def _until_known(seconds: float) -> float:
    """When the planner sees that an action is done: it ends with a tick, and it takes another one to know."""
    return (math.ceil(seconds / TICK - ROUNDING) + 1) * TICK


def fill_problem(text: str, ward: Ward, task: str, *, costs: LegCosts | None = None, name: str = "problem") -> str:
    """The text of a problem with its generated part made anew from the ward.

    Raises:
        BadInput: if the text has no generated part.
    """
    before, begin, rest = text.partition(_BEGIN)
    heading, _, rest = rest.partition("\n")
    _, end, after = rest.partition(_END)
    if not begin or not end:
        raise BadInput(name, "no generated part", f"lines with {_BEGIN!r} and {_END!r}")
    body = "".join(f"    {line}\n" for line in _generated_lines(ward, task, costs or LegCosts(ward)))
    return f"{before}{begin}{heading}\n{body}    {end}{after}"


def write_problem(path: Path, ward: Ward, task: str, *, costs: LegCosts | None = None) -> bool:
    """Makes the generated part of a problem file anew; returns whether that changed the file."""
    before = path.read_text(encoding="utf-8")
    after = fill_problem(before, ward, task, costs=costs, name=path.name)
    if after != before:
        path.write_text(after, encoding="utf-8")
    return after != before


def _generated_lines(ward: Ward, task: str, costs: LegCosts) -> Iterator[str]:
    open_ways, legs = leg_data(costs, ward, task)
    stock = {(STOCK_PREDICATES[task], item.kind, location_name(item.place)): None for item in all_items(ward, (task,))}
    yield from map(_fact, stock)
    for part in (table_fluents(task), place_fluents(costs, ward, task, legs)):
        yield from (_equation(fluent, value) for fluent, value in part.items())
    for way in open_ways:
        yield _fact(way)
        pair = way[1:]
        yield from (_equation(fluent, value) for fluent, value in legs.items() if fluent[1:] == pair)


def _fact(fact: Fact) -> str:
    return f"({' '.join(fact)})"


def _equation(fluent: Fact, value: Decimal) -> str:
    return f"(= {_fact(fluent)} {value})"


def _rounded(value: float, decimals: int) -> Decimal:
    """A decimal without superfluous zeros; adding zero takes the sign from a zero."""
    number = round(Decimal(value), decimals) + 0
    return number.quantize(Decimal(1)) if number == number.to_integral() else number.normalize()
