"""What tests of the care domains read off tasks, states and plans."""

from __future__ import annotations

from collections.abc import Sequence

from mala_drake.planning import PlanningTask, SymbolicState
from mala_drake.resources import domains_folder
from mala_drake.ward.ward_map import LoadWard


def care_domain(name: str) -> PlanningTask:
    """The task `med` or `meal`, as its two files have it."""
    folder = domains_folder()
    return PlanningTask.load(folder / f"domain_{name}.pddl", folder / f"problem_{name}.pddl")


def names(actions: Sequence[str]) -> list[str]:
    """The names of actions, without what they are done with."""
    return [action.strip("()").split()[0] for action in actions]


def possible_names(task: PlanningTask) -> set[str]:
    """The names of the actions that are possible in some state."""
    return set(names([action.name for action in task.grounding(task.initial_state).ground_task.actions]))


def place_of(state: SymbolicState) -> str:
    """Where the robot is, as the planner spells it."""
    (place,) = (fact[2] for fact in state.facts if fact[0] == "at")
    return place


def stops_of(task: PlanningTask, actions: Sequence[str], state: SymbolicState | None = None) -> tuple[str, ...]:
    """The places that a plan visits, as the map spells them; it begins in the initial state unless told otherwise."""
    spelling = {place.name.lower(): place.name for place in LoadWard().places}
    state, stops = task.initial_state if state is None else state, []
    for action in actions:
        after = task.apply(state, action)
        if place_of(after) != place_of(state):
            stops.append(spelling[place_of(after)])
        state = after
    return tuple(stops)


def at(state: SymbolicState, place: str, *facts: tuple[str, ...]) -> SymbolicState:
    """The state with the robot at a place, and with some more facts."""
    here = [fact for fact in state.facts if fact[0] == "at"]
    return state.with_facts(add=[("at", "robot1", place), *facts], remove=here)


def with_charge(state: SymbolicState, charge: float) -> SymbolicState:
    """The state with another state of charge."""
    return state.with_fluents({("battery-soc", "robot1"): charge})
