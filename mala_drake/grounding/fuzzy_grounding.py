"""The grounding as a system: from the continuous state to memberships and the crisp symbolic state."""

from __future__ import annotations

import math
from collections.abc import Mapping

from pydrake.common.value import Value
from pydrake.systems.framework import Context, LeafSystem

from mala_drake.grounding.atom_memberships import AT_A_PLACE, WITHIN_REACH
from mala_drake.grounding.atom_memberships import predicate_memberships as fuzzy_memberships
from mala_drake.grounding.defuzzification import INSTANTIATION_THRESHOLD
from mala_drake.grounding.location_grounding import IN_TRANSIT, LocationGrounding
from mala_drake.grounding.membership import AbstractMembership
from mala_drake.grounding.mismatch import location_error, location_error_gradient, reach_error
from mala_drake.grounding.predicates import (
    AbstractPredicateMembership,
    Observation,
    world_fact_truths,
)
from mala_drake.messages import (
    Action,
    ActionReport,
    Atom,
    Memberships,
    PlaceMismatch,
    RobotState,
    SymbolicState,
    WorldFacts,
)
from mala_drake.optional_input import told

SIGHT = 6.0
"""Metres within which the robot sees the mark of a place."""

_AT = "at"


class FuzzyGrounding(LeafSystem):
    """Says to what degree each atom is true, and which atoms hold.

    .. pydrake_system::

        name: FuzzyGrounding
        input_ports:
        - robot_state
        - world_facts
        - action
        - charge
        - in_place_report
        output_ports:
        - memberships
        - symbolic_state
        - place_mismatch
        - reach_mismatch

    It has no state: all outputs are functions of the inputs. `robot_state` is (x, y, yaw, v_x, v_y, omega_z), `charge`
    the state of charge.

    `(at ROBOT l)` holds only for the place with the highest membership, and only from the threshold up; in transit
    none does. Every other predicate has one membership function: one of `predicate_memberships`, else 1 for what
    `world_facts` lists; its atoms hold from the threshold up. `at` atoms of the robot itself among the world facts
    are ignored, since the robot's place is grounded in its position.

    `place_mismatch` is about the place of `action`: the continuous mismatch with its derivative, and where the place is
    as the robot sees it, within `SIGHT`. `reach_mismatch` is about what the action in place has found out of reach at
    its place, if `in_place_report` is connected and says so: no effect of the action can come true there, and the atom
    of having its things within reach is missing, to a degree.

    A robot state that is not finite is an ordinary event: no place is known then. A charge that is not finite counts
    as empty, the safe side.
    """

    def __init__(
        self,
        *,
        locations: Mapping[str, tuple[float, float]],
        robot: str = "robot1",
        threshold: float = INSTANTIATION_THRESHOLD,
        location_membership: AbstractMembership = AT_A_PLACE,
        predicate_memberships: Mapping[str, AbstractPredicateMembership] | None = None,
    ) -> None:
        """Constructs the grounding.

        Args:
            locations: centre (x, y) of each place, metres.
            robot: its name in the atoms.
            threshold: degree in (0, 1] from which an atom holds.
            location_membership: of a place, as a function of the distance in metres.
            predicate_memberships: by predicate; None for `battery-low` by charge alone.

        Raises:
            BadInput: if a place or the threshold is not valid.
        """
        super().__init__()
        self._robot = robot
        self._threshold = threshold
        self._grounding = LocationGrounding(locations, membership=location_membership, threshold=threshold)
        if predicate_memberships is None:
            predicate_memberships = fuzzy_memberships("fuzzy", robot=robot)
        self._predicates = tuple(predicate_memberships[name] for name in sorted(predicate_memberships))
        self._own_predicates = frozenset(predicate_memberships)
        self._robot_state = self.DeclareVectorInputPort("robot_state", 6)
        self._world_facts = self.DeclareAbstractInputPort("world_facts", Value(WorldFacts()))
        self._action = self.DeclareAbstractInputPort("action", Value(Action()))
        self._charge = self.DeclareVectorInputPort("charge", 1)
        inputs = {port.ticket() for port in (self._robot_state, self._world_facts, self._action, self._charge)}
        self._in_place_report = self.DeclareAbstractInputPort("in_place_report", Value(ActionReport()))
        self._memberships = self.DeclareAbstractOutputPort(
            "memberships", lambda: Value(Memberships()), self._calc_memberships, prerequisites_of_calc=inputs
        )
        self.DeclareAbstractOutputPort(
            "symbolic_state", lambda: Value(SymbolicState()), self._calc_symbolic_state, prerequisites_of_calc=inputs
        )
        self.DeclareAbstractOutputPort(
            "place_mismatch",
            lambda: Value(PlaceMismatch()),
            self._calc_place_mismatch,
            # Who asks for it every tick is not to have the world's facts worked out as often.
            prerequisites_of_calc={self._robot_state.ticket(), self._action.ticket()},
        )
        self.DeclareAbstractOutputPort(
            "reach_mismatch",
            lambda: Value(PlaceMismatch()),
            self._calc_reach_mismatch,
            prerequisites_of_calc={self._action.ticket(), self._in_place_report.ticket()},
        )

    def _estimate(self, context: Context) -> RobotState | None:
        """The robot's state, None where it is not finite."""
        estimate = self._robot_state.Eval(context).tolist()
        return RobotState(*estimate) if all(map(math.isfinite, estimate)) else None

    def _observe(self, context: Context) -> Observation:
        charge = float(self._charge.Eval(context)[0])
        return Observation(
            robot_state=self._estimate(context),
            charge=min(max(charge, 0.0), 1.0) if math.isfinite(charge) else 0.0,
            world_facts=self._world_facts.Eval(context),
            action=self._action.Eval(context),
        )

    def _location_truths(self, robot_state: RobotState | None) -> dict[Atom, float]:
        if robot_state is None:
            return {(_AT, self._robot, place): 0.0 for place in self._grounding.places}
        values = self._grounding.values((robot_state.x, robot_state.y)).tolist()
        return {(_AT, self._robot, place): value for place, value in zip(self._grounding.places, values, strict=True)}

    def _other_truths(self, observation: Observation) -> dict[Atom, float]:
        truths = world_fact_truths(observation.world_facts, except_predicates=self._own_predicates)
        for predicate in self._predicates:
            truths.update(predicate.truths(observation))
        return {atom: truth for atom, truth in truths.items() if atom[:2] != (_AT, self._robot)}

    def _calc_memberships(self, context: Context, output: Value) -> None:
        observation = self._observe(context)
        truths = self._location_truths(observation.robot_state) | self._other_truths(observation)
        output.set_value(Memberships(tuple(truths), tuple(truths.values())))

    def _calc_symbolic_state(self, context: Context, output: Value) -> None:
        observation = self._observe(context)
        memberships = self._memberships.Eval(context)
        count = len(self._grounding.places)
        place = self._grounding.place(memberships.values[:count], expected=observation.action.place)
        others = zip(memberships.atoms[count:], memberships.values[count:], strict=True)
        atoms = [atom for atom, value in others if value >= self._threshold]
        if place != IN_TRANSIT:
            atoms.append((_AT, self._robot, place))
        output.set_value(SymbolicState(tuple(sorted(atoms)), place, observation.charge))

    def _calc_place_mismatch(self, context: Context, output: Value) -> None:
        place, robot_state = self._action.Eval(context).place, self._estimate(context)
        if robot_state is None or place not in self._grounding.places:
            output.set_value(PlaceMismatch())
            return
        position, location = (robot_state.x, robot_state.y), self._grounding.location(place)
        x, y = location_error_gradient(location, position).tolist()
        offset = location.centre[0] - position[0], location.centre[1] - position[1]
        seen = math.hypot(*offset) <= SIGHT
        error = float(location_error(location, position))
        output.set_value(PlaceMismatch(place, error, (x, y), offset if seen else None))

    def _calc_reach_mismatch(self, context: Context, output: Value) -> None:
        action: Action = self._action.Eval(context)
        report = told(self._in_place_report, context, ActionReport())
        if report.shortfall is None or report.sequence != action.sequence:
            output.set_value(PlaceMismatch())
            return
        output.set_value(PlaceMismatch(action.place, *reach_error(WITHIN_REACH, report.shortfall)))
