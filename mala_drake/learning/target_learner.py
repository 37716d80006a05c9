"""The target learner as a system: what is missing at the ends of legs in, learned targets out."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import Context, DiscreteValues

from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.learning.abstract_learner import FloatArray
from mala_drake.learning.end_sensitivity import EndSensitivity, by_identity, plausible_sensitivity
from mala_drake.learning.leg_learner import LegLearner
from mala_drake.learning.target_estimator import PLATEAU_MARGIN, MissingAtom, TargetEstimator, TargetEvidence
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    DrivenLeg,
    LearnedTargets,
    LearnedWeights,
    Obstacles,
    Outcome,
    PlaceMismatch,
    SensitivitySource,
    Shape,
)
from mala_drake.optional_input import told
from mala_drake.ward.routes import GOAL_DISTANCE
from mala_drake.ward.shapes import ShapeDistances

_logger = logging.getLogger(__name__)

_REACH_MARGIN = 0.15
"""Metres inside the arm's reach that a step aims at; at the places of the map there are 0.2 to 0.25."""

STANDING_DISTANCE = 0.5
"""Metres from anything solid that a target keeps if it is free to; so far off it are the places of the map."""

_SOURCES = tuple(SensitivitySource)  # In the order of the state.

_NOT_THERE = (Outcome.BLOCKED, Outcome.WAYPOINT_ALLOCATION, Outcome.STEP_BUDGET)  # Legs that could not be driven.


class LegSensitivity(Protocol):
    """Who knows how the end of a leg moves with its target."""

    def __call__(self, leg: DrivenLeg) -> FloatArray:
        """D (x, y at the end) / d (x, y of the target), shape (2, 2).

        Raises:
            RuntimeError: there is no such derivative; says why.
        """


class TargetLearner(LegLearner):
    """Learns where legs to places are to end, from what is missing at their ends.

    .. pydrake_system::

        name: TargetLearner
        input_ports:
        - action
        - robot_state
        - obstacles
        - magnet
        - preferences
        - learned_dynamics
        - leg_report
        - in_place_report
        - place_mismatch
        - reach_mismatch
        - learned_weights
        output_ports:
        - learned_targets

    There is evidence in

    - a leg that has stopped at its target: the missing membership of being at the place, and where the place is seen;
    - a leg that could not be driven to its target: where the place is seen, or, if the target is where something
      stands, the missing membership;
    - an action in place that has found its things out of reach: by how much. It is about the leg before. Who goes by
      the place as it is seen does not need it.

    A leg that has stopped is simulated in closed loop over the controller's model, from the state that the robot began
    it in, to find out how its end moves with its target. `learned_dynamics` is that model, if it is connected and there
    is one; `learned_weights` are those of the controller, as it was told them when the leg began, if they are
    connected. What happens to the robot is not touched: the planner sees the mismatch as ever, and its next leg to the
    place goes to the new target.

    Targets stay clear of what is on the map and of what the sensor sees at the end of the leg.

    The discrete state is the learner's own vector, the sequence of the last report, and which sensitivity the newest
    update went through; the abstract state is what is known of the last legs.
    """

    def __init__(
        self,
        *,
        learner: TargetEstimator,
        yaws: Mapping[str, float],
        sensitivity: LegSensitivity | None,
        mapped: Sequence[Shape],
        geometric: bool = False,
    ) -> None:
        """Constructs the system around a learner that has learned nothing yet.

        Args:
            learner: what learns.
            yaws: at the targets, by place, radians.
            sensitivity: of legs; None to take the identity for that of each.
            mapped: solid shapes of the map.
            geometric: whether the place as it is seen counts as well, beside the missing membership.
        """
        super().__init__()
        self._learner = learner
        self._yaws = dict(yaws)
        self._sensitivity = sensitivity
        self._mapped = tuple(mapped)
        self._geometric = geometric
        self._declare_legs()
        self._leg_report = self.DeclareAbstractInputPort("leg_report", Value(ActionReport()))
        self._in_place_report = self.DeclareAbstractInputPort("in_place_report", Value(ActionReport()))
        self._place_mismatch = self.DeclareAbstractInputPort("place_mismatch", Value(PlaceMismatch()))
        self._reach_mismatch = self.DeclareAbstractInputPort("reach_mismatch", Value(PlaceMismatch()))
        self._learned_weights = self.DeclareAbstractInputPort("learned_weights", Value(LearnedWeights()))
        self._declare_learned("learned_targets", LearnedTargets(), initial_state=learner.initial_state(), marks=3)
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._update)

    def _learned(self, context: Context) -> LearnedTargets:
        _, source, deviation = self._marks(context).tolist()
        learned = self._learner.learned(self.learner_state(context))
        return replace(
            learned,
            sensitivity=_SOURCES[int(source)],
            deviation=deviation if source and math.isfinite(deviation) else None,
        )

    def _target(self, context: Context, place: str) -> tuple[float, float, float]:
        if place not in self._learner.places:
            return (0.0, 0.0, 0.0)
        return (*self._learner.target(self.learner_state(context), place), self._yaws[place])

    def _weights_told(self, context: Context) -> LearnedWeights:
        return told(self._learned_weights, context, LearnedWeights())

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        state, marks = self.learner_state(context), self._marks(context)
        action: Action = self._action.Eval(context)
        port = self._leg_report if action.kind is ActionKind.MOVE else self._in_place_report
        report: ActionReport = port.Eval(context)
        if report.finished and report.sequence == action.sequence and report.sequence > marks[0]:
            marks[0] = report.sequence
            learned = self._learned_from(context, state, action, report.outcome)
            if learned is not None:
                state, sensitivity = learned
                marks[1:] = _SOURCES.index(sensitivity.source), _number(sensitivity.deviation)
        discrete_state.set_value(np.append(state, marks))

    def _learned_from(
        self, context: Context, state: FloatArray, action: Action, outcome: Outcome
    ) -> tuple[FloatArray, EndSensitivity] | None:
        """The learner's state after an action that has ended, and what it was updated through; None if it was not."""
        leg, found = self._newest_leg(context), None
        if action.kind is ActionKind.MOVE:
            found = self._evidence_of_leg(context, state, leg, outcome)
        elif outcome is Outcome.OUT_OF_REACH and not self._geometric:
            found = self._evidence_of_reach(context, leg)
        if found is None:
            return None
        evidence, sensitivity = found
        # The place as it is seen is where it is; the plateaus of the atoms leave room.
        distance = STANDING_DISTANCE if evidence.offset is None else GOAL_DISTANCE
        clear = self._clearance(context)
        after = self._learner.update(state, action.place, evidence, is_free=lambda point: clear(point) >= distance)
        return None if np.array_equal(after, state) else (after, sensitivity)

    def _evidence_of_leg(
        self, context: Context, state: FloatArray, leg: DrivenLeg, outcome: Outcome
    ) -> tuple[TargetEvidence, EndSensitivity] | None:
        mismatch: PlaceMismatch = self._place_mismatch.Eval(context)
        if mismatch.place not in self._learner.places or mismatch.place != leg.action.place:
            return None
        offset = np.array(mismatch.offset) if self._geometric and mismatch.offset is not None else None
        if outcome is Outcome.SUCCESS:
            if self._learner.is_settled(state, mismatch.place, mismatch.error, offset):
                return None
            sensitivity, about = self._sensitivity_of(leg), leg.target[:2]
        elif outcome not in _NOT_THERE or (
            offset is None and self._clearance(context)(leg.target[:2]) >= GOAL_DISTANCE
        ):
            return None
        else:
            # What is missing where the robot is says where the target should be, wherever it was.
            x, y = self._robot_state.Eval(context)[:2].tolist()
            sensitivity, about = by_identity(SensitivitySource.NOT_NEEDED), (x, y)
        matrix = sensitivity.matrix
        return TargetEvidence((_missing(mismatch, matrix),), offset, matrix, about), sensitivity

    def _evidence_of_reach(self, context: Context, leg: DrivenLeg) -> tuple[TargetEvidence, EndSensitivity] | None:
        reach: PlaceMismatch = self._reach_mismatch.Eval(context)
        if reach.error == 0.0 or reach.place not in self._learner.places or reach.place != leg.action.place:
            return None
        sensitivity = self._sensitivity_of(leg)
        matrix = sensitivity.matrix
        missing = [_missing(reach, matrix, _REACH_MARGIN)]
        place: PlaceMismatch = self._place_mismatch.Eval(context)
        if place.place == reach.place:  # The robot still stands where the leg has ended.
            missing.append(_missing(place, matrix))
        return TargetEvidence(tuple(missing), None, matrix, leg.target[:2]), sensitivity

    def _sensitivity_of(self, leg: DrivenLeg) -> EndSensitivity:
        """D (x, y at the end) / d (x, y of the target) of the newest leg."""
        if self._sensitivity is None:
            return by_identity(SensitivitySource.IDENTITY)
        simulated, trouble = None, "is too far from the identity"
        try:
            simulated = self._sensitivity(leg)
        except RuntimeError as error:
            trouble = str(error)
        found = plausible_sensitivity(simulated)
        if found.source is SensitivitySource.FALLBACK:
            _logger.info(
                "the end of the leg to %s is taken to move as its target: simulated, it %s", leg.action.place, trouble
            )
        return found

    def _clearance(self, context: Context) -> Callable[[tuple[float, float]], float]:
        """The distance of a point to anything solid, as far as the robot knows and sees, metres."""
        seen: Obstacles = self._obstacles.Eval(context)
        distances = ShapeDistances((*self._mapped, *seen.shapes))
        return lambda point: float(distances(point).min())


def _missing(mismatch: PlaceMismatch, sensitivity: FloatArray, margin: float = PLATEAU_MARGIN) -> MissingAtom:
    """The atom of a mismatch, by the target of a leg with this sensitivity."""
    return MissingAtom(mismatch.error, np.array(mismatch.gradient) @ sensitivity, margin)


def _number(value: float | None) -> float:
    return math.nan if value is None else value
