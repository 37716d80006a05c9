"""Memberships of atoms that are not places: one function a predicate (paper, footnote on predicates)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

from mala_drake.grounding.location import LocationMembership
from mala_drake.grounding.membership import AbstractMembership
from mala_drake.grounding.saturated_ramp import SaturatedRamp
from mala_drake.messages import Action, Atom, RobotState, WorldFacts


@dataclass(frozen=True, slots=True)
class Observation:
    """Everything that memberships may depend on, all of it finite."""

    robot_state: RobotState | None  # None when the estimate is not finite.
    charge: float  # State of charge in [0, 1].
    world_facts: WorldFacts
    action: Action


class AbstractPredicateMembership(ABC):
    """The membership function shared by all atoms of one predicate."""

    __slots__ = ()

    @abstractmethod
    def truths(self, observation: Observation) -> Mapping[Atom, float]:
        """The degree of truth in [0, 1] of each of the predicate's atoms that the observation tells about."""


@dataclass(frozen=True, slots=True)
class ChargeMembership(AbstractPredicateMembership):
    """The membership of one atom as a function of the state of charge.

    Attributes:
        atom: for example ("battery-low", "robot1").
        membership: of the charge in [0, 1]. The default falls from 1 to 0 between the two charges at which the
            planner's low-battery penalties set in.
    """

    atom: Atom
    membership: AbstractMembership = SaturatedRamp(full=0.15, zero=0.25)

    def truths(self, observation: Observation) -> Mapping[Atom, float]:
        """The one atom's."""
        return {self.atom: float(self.membership.value(observation.charge))}


@dataclass(frozen=True, slots=True)
class ProximityMembership(AbstractPredicateMembership):
    """The membership of being near something, by distance; nothing is known when the robot's state is not.

    Attributes:
        locations: the fuzzy region of each atom, for example of ("near", "robot1", "patient1").
    """

    locations: tuple[tuple[Atom, LocationMembership], ...]

    def truths(self, observation: Observation) -> Mapping[Atom, float]:
        """One degree an atom."""
        robot_state = observation.robot_state
        if robot_state is None:
            return {}
        position = (robot_state.x, robot_state.y)
        return {atom: float(location.value(position)) for atom, location in self.locations}


def world_fact_truths(facts: WorldFacts, *, except_predicates: frozenset[str]) -> dict[Atom, float]:
    """What the sensors have established, as degrees: 1 for each fact, of predicates without a function of their own."""
    return {atom: 1.0 for atom in sorted(facts.atoms) if atom[0] not in except_predicates}
