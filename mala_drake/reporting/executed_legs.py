"""Which legs the robot drove, read from the actions of the executed plans and from the PDDL files that define them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

from mala_drake.planning.care_tasks import TASK_NAMES, CareTask
from mala_drake.planning.syntax import ActionSchema, SetFact
from mala_drake.reporting.results import Run
from mala_drake.ward.cost_parameters import location_name
from mala_drake.ward.ward_map import Ward

_AT = "at"
"""The predicate that says where the robot is."""


@dataclass(frozen=True)
class ExecutedLegs:
    """Legs between places of the map and how often they were driven.

    Attributes:
        counts: by start and goal, as the map spells them.
        episodes: they were counted in.
        left_out: legs that began between places, of which nothing tells where.
    """

    counts: Counter[tuple[str, str]]
    episodes: int
    left_out: int


def executed_legs(runs: Iterable[Run], task: str, ward: Ward) -> ExecutedLegs:
    """The legs of all episodes of a task that reached their goal."""
    schemas = _schemas(task, ward)
    places = {location_name(place.name): place.name for place in ward.places}
    counts: Counter[tuple[str, str]] = Counter()
    episodes = left_out = 0
    for record in (record for run in runs for record in run.of_task(task) if record.success):
        episodes += 1
        for action in record.actions:
            start, goal = movement(schemas, action)
            if goal is None:
                continue
            if start in places and goal in places:
                counts[places[start], places[goal]] += 1
            else:
                left_out += 1
    return ExecutedLegs(counts, episodes, left_out)


@lru_cache(maxsize=8)
def _schemas(task: str, ward: Ward) -> Mapping[str, ActionSchema]:
    if task not in TASK_NAMES:
        return {}
    return {schema.name: schema for schema in CareTask(task, ward).planning_task.description.actions}


def movement(schemas: Mapping[str, ActionSchema], action: str) -> tuple[str | None, str | None]:
    """From where to where an action such as `(go_to_supply_a robot1 home)` moves the robot; None, None if it does not.

    The goal is what its effects make true of `at`, the start what they make false.
    """
    name, *objects = action.strip("()").split()
    schema = schemas.get(name)
    if schema is None or len(objects) != len(schema.parameters):
        return None, None
    binding = {parameter.name: each for parameter, each in zip(schema.parameters, objects, strict=True)}
    start = goal = None
    for effect in schema.effects:
        if isinstance(effect, SetFact) and effect.atom.predicate == _AT:
            location = binding.get(effect.atom.terms[-1], effect.atom.terms[-1])
            start, goal = (start, location) if effect.value else (location, goal)
    return (start, goal) if goal is not None else (None, None)
