"""The care robot's tasks as planning problems: between the messages of the diagram and the states of the planner."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable

from mala_drake.errors import BadInput
from mala_drake.messages import Action, ActionKind, Atom, LearnedCosts
from mala_drake.messages import SymbolicState as ObservedState
from mala_drake.planning.features import IN_TRANSIT, STOCK_PREDICATES, fill_problem, leg_fluents, leg_reserve
from mala_drake.planning.learned_costs import NOTHING_LEARNED, learned_fluents, learned_leg
from mala_drake.planning.leg_costs import NO_COST, LegCosts, Pose
from mala_drake.planning.source import read_text
from mala_drake.planning.state import Amount, Name, SymbolicState
from mala_drake.planning.syntax import Fact
from mala_drake.planning.task import PlanningTask
from mala_drake.planning.ways import WAY_PREDICATES, targets
from mala_drake.preferences import CRITERIA
from mala_drake.resources import domains_folder
from mala_drake.ward.cost_parameters import LEARNED_NAMES, location_name
from mala_drake.ward.ward_map import LoadWard, Ward

TASK_NAMES = ("medication", "meal")
"""The tasks that a scheduler may issue."""

_FILES = {
    "medication": ("domain_med.pddl", "problem_med.pddl"),
    "meal": ("domain_meal.pddl", "problem_meal.pddl"),
}
_CHARGE = "battery-soc"
_PLENTY = 10  # Batteries full.
_NOT_OBSERVED = frozenset({*WAY_PREDICATES.values(), "requested-medicine", "requested-supplement", "requires_cooking"})
"""Predicates that the problem and the planner know, not the grounding."""


class CareTask:
    """One kind of task in one ward.

    Locations of the planner are places of the map in lower case, and `in_transit` wherever the robot stands at none of
    them; messages spell places as the map does.

    Attributes:
        name: of the task, one of `TASK_NAMES`.
        planning_task: its domain and problem.
    """

    def __init__(self, name: str, ward: Ward, *, costs: LegCosts | None = None, robot: str = "robot1") -> None:
        """Reads the task; its numbers are made anew if the ward is not the one that comes with the package.

        Args:
            name: one of `TASK_NAMES`.
            ward: the map.
            costs: predictions of legs; None for those of this ward and robot.
            robot: its name in the atoms.

        Raises:
            BadInput: if there is no such task, or the domain speaks of places that the ward does not have.
        """
        if name not in _FILES:
            raise BadInput("task", repr(name), f"one of {', '.join(TASK_NAMES)}")
        self.name = name
        self._robot = robot
        self._costs = costs or LegCosts(ward)
        domain, problem = (domains_folder() / file for file in _FILES[name])
        text = read_text(problem)
        if costs is not None or ward != LoadWard():
            text = fill_problem(text, ward, name, costs=self._costs, name=problem.name)
        self.planning_task = PlanningTask.parse(
            read_text(domain), text, domain_name=domain.name, problem_name=problem.name
        )
        self._way = WAY_PREDICATES[name]
        self._places = {location_name(place.name): place.name for place in ward.places}
        self._targets = tuple(place.name for place in targets(ward, name))
        self._locations = frozenset(self.planning_task.description.objects_of(("location",)))
        missing = sorted(each for each in self._locations if not self._knows(each))
        if missing:
            raise BadInput(f"ward {ward.name}", f"has no place {missing[0]}", "every location of the domain")

    def place(self, state: SymbolicState) -> str:
        """Where the robot is in a state of the planner, as the map spells it; empty in transit."""
        return self._places.get(self._location(state), "")

    @property
    def predictions(self) -> dict[Fact, float]:
        """The fluents that can be learned, as predicted from the map."""
        values = self.planning_task.initial_state.values
        return {name: float(value) for name, value in values.items() if name[0] in LEARNED_NAMES}

    def observed_state(
        self,
        observed: ObservedState,
        pose: Pose,
        *,
        standing_at: str,
        closed: Collection[tuple[str, str]] = (),
        learned: LearnedCosts = NOTHING_LEARNED,
    ) -> SymbolicState:
        """The planner's state for what is observed now.

        A robot that is near a place but has not stopped at its standing pose cannot do there what the place is for: it
        counts as in transit, and its legs are predicted from where it is.

        Args:
            observed: the atoms that hold, and the charge. Atoms that the domain does not know are left out.
            pose: of the robot: x, y, yaw.
            standing_at: the place whose standing pose the robot has last stopped at, empty for none.
            closed: pairs of locations between which the way has been found blocked.
            learned: what is better known than predicted.

        Raises:
            ValueError: if the pose is needed and not finite.
        """
        initial = self.planning_task.initial_state
        facts = {fact for fact in initial.facts if fact[0] in _NOT_OBSERVED}
        facts -= {(self._way, *pair) for pair in closed}
        facts |= {fact for fact in map(_lower, observed.atoms) if fact[0] != "at" and self._is_observable(fact)}
        at_place = observed.place == standing_at and location_name(observed.place) in self._locations
        facts.add(("at", self._robot, location_name(observed.place) if at_place else IN_TRANSIT))
        state = SymbolicState(frozenset(facts), initial.values)
        state = state.with_fluents(learned_fluents(initial.values, learned))
        if not at_place:
            state = state.with_fluents(self._transit_fluents(pose, learned))
        return state.with_fluents({(_CHARGE, self._robot): observed.charge})

    def typical_states(self) -> tuple[SymbolicState, ...]:
        """A state at a place and one in transit: between them they need every ground action of the task."""
        initial = self.planning_task.initial_state
        here = ("at", self._robot, self._location(initial))
        legs: dict[Name, Amount] = {
            fluent: 0 for place in self._targets for fluent in leg_fluents(NO_COST, IN_TRANSIT, location_name(place))
        }
        in_transit = initial.with_facts(add=[("at", self._robot, IN_TRANSIT)], remove=[here]).with_fluents(legs)
        return (initial, in_transit)

    def mismatch(self, expected: SymbolicState, observed: ObservedState) -> tuple[Atom, ...]:
        """The atoms in which the observed state differs from the expected one, sorted.

        What is in stock is not the robot's doing: it is observed, not predicted.
        """
        seen = {fact for fact in map(_lower, observed.atoms) if self._is_observable(fact)}
        return tuple(sorted(self._own(expected.facts) ^ self._own(seen)))

    def action(self, text: str, before: SymbolicState, after: SymbolicState, *, sequence: int) -> Action:
        """The message for an action `(name argument ...)` that leads from one state to another.

        What changes the robot's location is a movement to the new one; all else is done in place.
        """
        name, *arguments = text.strip("()").split()
        moves = self._location(before) != self._location(after)
        kind = ActionKind.MOVE if moves else ActionKind.IN_PLACE
        return Action(
            sequence, kind, name, tuple(arguments), place=self.place(after), previous_place=self.place(before)
        )

    def features(self, before: SymbolicState, text: str) -> tuple[float, ...]:
        """The five features that the domain predicts for an action, scaled: its stage cost under each weight alone.

        The penalty for a low charge belongs to the plan's cost, not to the battery feature, which is the charge used:
        the action is looked at with so much charge that there is none.
        """
        rested = before.with_fluents({(_CHARGE, self._robot): _PLENTY})
        features = []
        for i in range(len(CRITERIA)):
            start = self.planning_task.with_weights(rested, [int(i == j) for j in range(len(CRITERIA))])
            features.append(self._change(start, self.planning_task.apply(start, text), ("stage_cost",)))
        return tuple(features)

    def ways_closed_by(self, action: Action) -> tuple[tuple[str, str], ...]:
        """The ways that a blocked leg closes: from where it began and from where the robot is now.

        A leg that began in transit closes all ways to its target.
        """
        goal = location_name(action.place)
        if action.previous_place:
            return ((location_name(action.previous_place), goal), (IN_TRANSIT, goal))
        facts = sorted(self.planning_task.initial_state.facts)
        return tuple((fact[1], goal) for fact in facts if fact[0] == self._way and fact[2] == goal)

    def _transit_fluents(self, pose: Pose, learned: LearnedCosts) -> dict[Name, Amount]:
        if not all(map(math.isfinite, pose)):
            raise ValueError(f"the pose {pose} is not finite")
        fluents: dict[Name, Amount] = {}
        for place in self._targets:
            predicted = self._costs.from_pose(pose, place)
            if predicted is not None:
                way = IN_TRANSIT, location_name(place)
                known = learned_leg(predicted, learned)
                reserve = leg_reserve(max(predicted.charge, known.charge), *way)
                for fluent, value in (leg_fluents(known, *way) | reserve).items():
                    fluents[fluent] = value
        return fluents

    def _location(self, state: SymbolicState) -> str:
        return next((fact[2] for fact in state.facts if fact[:2] == ("at", self._robot)), IN_TRANSIT)

    def _own(self, facts: Iterable[Fact]) -> set[Fact]:
        left_out = {*_NOT_OBSERVED, *STOCK_PREDICATES.values()}
        return {fact for fact in facts if fact[0] not in left_out and fact != ("at", self._robot, IN_TRANSIT)}

    def _is_observable(self, fact: Fact) -> bool:
        description = self.planning_task.description
        signature = description.predicates.get(fact[0])
        return (
            signature is not None
            and fact[0] not in _NOT_OBSERVED
            and len(signature) == len(fact) - 1
            and all(name in description.objects for name in fact[1:])
        )

    def _knows(self, location: str) -> bool:
        return location == IN_TRANSIT or location in self._places

    @staticmethod
    def _change(before: SymbolicState, after: SymbolicState, fluent: Fact) -> float:
        return float(after.values[fluent] - before.values[fluent])


def _lower(atom: Atom) -> Fact:
    return tuple(name.lower() for name in atom)
