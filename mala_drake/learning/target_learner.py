"""The target learner as a system: what is missing at the ends of legs in, learned targets out."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import Context, DiscreteValues, LeafSystem

from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.learning.abstract_learner import FloatArray
from mala_drake.learning.target_estimator import TargetEstimator, TargetEvidence
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    LearnedTargets,
    MagnetCommand,
    Obstacles,
    Outcome,
    PlaceMismatch,
    Preferences,
    Shape,
)
from mala_drake.ward.routes import GOAL_DISTANCE
from mala_drake.ward.shapes import ShapeDistances

_logger = logging.getLogger(__name__)

_BEGUN, _SEEN = 0, 1
_MARKS = 8  # Sequence of the leg under way, of the last one learned from, and z_0 of the one under way.


class LegSensitivity(Protocol):
    """Who knows how the end of a leg moves with its target."""

    def __call__(
        self,
        initial_state: FloatArray,
        target: tuple[float, float, float],
        obstacles: Sequence[Shape],
        *,
        action: Action,
        carrying: bool,
        weights: Sequence[float],
    ) -> FloatArray:
        """D (x, y at the end) / d (x, y of the target), shape (2, 2).

        Raises:
            RuntimeError: there is no such derivative; says why.
        """


class TargetLearner(LeafSystem):
    """Learns where legs to places are to end, once from each leg that has stopped at its target.

    .. pydrake_system::

        name: TargetLearner
        input_ports:
        - action
        - leg_report
        - place_mismatch
        - robot_state
        - obstacles
        - magnet
        - preferences
        output_ports:
        - learned_targets

    A leg from whose end there is something to learn is simulated in closed loop over the prediction model, from the
    state that the robot began it in, to find out how its end moves with its target. What happens to the robot is not
    touched: the planner sees the mismatch as ever, and its next leg to the place goes to the new target.

    A leg without a sensitivity teaches nothing; the next one will. Targets stay clear of what is on the map and of what
    the sensor sees at the end of the leg.

    The discrete state is the learner's own vector followed by the sequence numbers of the leg under way and of the last
    one learned from, and the state in which the one under way began.
    """

    def __init__(
        self,
        *,
        learner: TargetEstimator,
        yaws: Mapping[str, float],
        sensitivity: LegSensitivity,
        mapped: Sequence[Shape],
        geometric: bool = False,
    ) -> None:
        """Constructs the system around a learner that has learned nothing yet.

        Args:
            learner: what learns.
            yaws: at the targets, by place, radians.
            sensitivity: of legs.
            mapped: solid shapes of the map.
            geometric: whether the place as it is seen counts as well, beside the missing membership.
        """
        super().__init__()
        self._learner = learner
        self._yaws = dict(yaws)
        self._sensitivity = sensitivity
        self._mapped = tuple(mapped)
        self._geometric = geometric
        self._action = self.DeclareAbstractInputPort("action", Value(Action()))
        self._leg_report = self.DeclareAbstractInputPort("leg_report", Value(ActionReport()))
        self._place_mismatch = self.DeclareAbstractInputPort("place_mismatch", Value(PlaceMismatch()))
        self._robot_state = self.DeclareVectorInputPort("robot_state", 6)
        self._obstacles = self.DeclareAbstractInputPort("obstacles", Value(Obstacles()))
        self._magnet = self.DeclareAbstractInputPort("magnet", Value(MagnetCommand()))
        self._preferences = self.DeclareAbstractInputPort("preferences", Value(Preferences()))
        index = self.DeclareDiscreteState(np.append(learner.initial_state(), np.zeros(_MARKS)))
        self.DeclareAbstractOutputPort(
            "learned_targets",
            lambda: Value(LearnedTargets()),
            self._calc_learned_targets,
            prerequisites_of_calc={self.discrete_state_ticket(index)},
        )
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._update)

    def learner_state(self, context: Context) -> FloatArray:
        """The learner's state in `context`, for a checkpoint."""
        vector: FloatArray = context.get_discrete_state_vector().value()
        return vector[:-_MARKS].copy()

    def set_learner_state(self, context: Context, state: FloatArray, *, episode: int) -> None:  # noqa: ARG002
        """Puts what was learned before into `context`, in which no leg has begun yet.

        Args:
            context: of this system.
            state: of the learner, as `learner_state` gave it.
            episode: the number of the next one; targets are learned in all alike.
        """
        context.SetDiscreteState(np.append(state, np.zeros(_MARKS)))

    def _calc_learned_targets(self, context: Context, output: Value) -> None:
        output.set_value(self._learner.learned(self.learner_state(context)))

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        learned = self.learner_state(context)
        marks = context.get_discrete_state_vector().value()[-_MARKS:].copy()
        action: Action = self._action.Eval(context)
        report: ActionReport = self._leg_report.Eval(context)
        if action.kind is ActionKind.MOVE and action.sequence > marks[_BEGUN]:
            marks[_BEGUN], marks[2:] = action.sequence, self._robot_state.Eval(context)
        ended = report.finished and report.sequence == action.sequence and report.sequence > marks[_SEEN]
        if ended:
            marks[_SEEN] = report.sequence
            if report.outcome is Outcome.SUCCESS:
                learned = self._learned_from_leg(context, learned, marks[2:])
        discrete_state.set_value(np.append(learned, marks))

    def _learned_from_leg(self, context: Context, state: FloatArray, began: FloatArray) -> FloatArray:
        """The learner's state after a leg that has stopped at its target."""
        action: Action = self._action.Eval(context)
        mismatch: PlaceMismatch = self._place_mismatch.Eval(context)
        seen: Obstacles = self._obstacles.Eval(context)
        place = mismatch.place
        offset = np.array(mismatch.offset) if self._geometric and mismatch.offset is not None else None
        if place != action.place or self._learner.is_settled(state, place, mismatch.error, offset):
            return state
        try:
            sensitivity = self._sensitivity(
                began,
                (*self._learner.target(state, place), self._yaws[place]),
                seen.shapes,
                action=action,
                carrying=bool(self._magnet.Eval(context).held),
                weights=self._preferences.Eval(context).estimate,
            )
        except RuntimeError as error:
            _logger.info("nothing is learned from the leg to %s: simulated, it %s", place, error)
            return state
        evidence = TargetEvidence(mismatch.error, np.array(mismatch.gradient) @ sensitivity, offset, sensitivity)
        distances = ShapeDistances((*self._mapped, *seen.shapes))
        return self._learner.update(
            state, place, evidence, is_free=lambda point: float(distances(point).min()) >= GOAL_DISTANCE
        )
