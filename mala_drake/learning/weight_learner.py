"""The weight learner as a system: what legs cost beside what was predicted in, the controller's weights out."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import Context, DiscreteValues

from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.learning.abstract_learner import FloatArray
from mala_drake.learning.learner_system import LearnerSystem
from mala_drake.learning.translation_estimator import TranslationEstimator
from mala_drake.learning.weight_estimator import WeightEstimator
from mala_drake.messages import (
    Action,
    ActionEvaluation,
    ActionKind,
    LearnedDynamics,
    LearnedTargets,
    LearnedWeights,
    MagnetCommand,
    Obstacles,
    Outcome,
    Preferences,
    Shape,
)

_logger = logging.getLogger(__name__)

_NOTHING = np.zeros(0)  # The state of what is not learned.


_BEGUN, _SEEN, _CARRYING = range(3)  # Sequences of the leg under way and of the last evaluation, and 1 for a load.
_BEGAN, _TARGET = slice(3, 9), slice(9, 12)  # The state in which it began, and the pose that it was to end in.
_MARKS = 12


class CostGradient(Protocol):
    """Who knows how the cost of a leg moves with its weights."""

    def __call__(
        self,
        initial_state: FloatArray,
        target: tuple[float, float, float],
        obstacles: Sequence[Shape],
        *,
        action: Action,
        carrying: bool,
        weights: Sequence[float],
        prices: Sequence[float],
        learned: LearnedWeights,
        dynamics: LearnedDynamics,
    ) -> FloatArray:
        """D cost / d log of the diagonal entries of Q and R, shape (9,).

        Raises:
            RuntimeError: there is no such derivative; says why.
        """


class WeightLearner(LearnerSystem):
    """Learns what is to cost the controller, once from each leg that has ended well.

    .. pydrake_system::

        name: WeightLearner
        input_ports:
        - action
        - action_evaluation
        - robot_state
        - obstacles
        - magnet
        - preferences
        - learned_targets
        - learned_dynamics
        output_ports:
        - learned_weights

    Factors of the weights by the place that a leg leads to (p^g), the translation from preferences to weights, or both
    move along the gradient of the leg's cost, such that the mismatch E^C falls. For it the leg is simulated in closed
    loop over the controller's model, as it began and with the weights learned so far. `learned_targets` and
    `learned_dynamics` are what the controller is told, where they are connected.

    A leg that failed, or whose cost has no derivative, teaches nothing. The discrete state is the vectors of both
    learners, followed by what is known of the leg under way.
    """

    def __init__(
        self,
        *,
        weights: WeightEstimator | None,
        translation: TranslationEstimator | None,
        targets: Mapping[str, tuple[float, float, float]],
        gradient: CostGradient,
    ) -> None:
        """Constructs the system around learners that have learned nothing yet.

        Args:
            weights: learns factors by place; None if nobody does.
            translation: learns how preferences become weights; None if nobody does.
            targets: poses (x, y, yaw) by place, as on the map.
            gradient: of legs.
        """
        super().__init__()
        self._weights = weights
        self._translation = translation
        self._targets = dict(targets)
        self._gradient = gradient
        self._action = self.DeclareAbstractInputPort("action", Value(Action()))
        self._evaluation = self.DeclareAbstractInputPort("action_evaluation", Value(ActionEvaluation()))
        self._robot_state = self.DeclareVectorInputPort("robot_state", 6)
        self._obstacles = self.DeclareAbstractInputPort("obstacles", Value(Obstacles()))
        self._magnet = self.DeclareAbstractInputPort("magnet", Value(MagnetCommand()))
        self._preferences = self.DeclareAbstractInputPort("preferences", Value(Preferences()))
        self._learned_targets = self.DeclareAbstractInputPort("learned_targets", Value(LearnedTargets()))
        self._learned_dynamics = self.DeclareAbstractInputPort("learned_dynamics", Value(LearnedDynamics()))
        factors = _NOTHING if weights is None else weights.initial_state()
        gains = _NOTHING if translation is None else translation.initial_state()
        self._split = factors.size
        self._declare_learned(
            "learned_weights", LearnedWeights(), initial_state=np.append(factors, gains), marks=_MARKS
        )
        # The action meter's update is unrestricted, this one discrete: it hears of an action in the same instant.
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._update)

    def _learned(self, context: Context) -> LearnedWeights:
        factors, gains = np.split(self.learner_state(context), [self._split])
        return LearnedWeights(
            () if self._weights is None else self._weights.learned(factors),
            () if self._translation is None else self._translation.learned(gains),
        )

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        state, marks = self.learner_state(context), self._marks(context)
        evaluation: ActionEvaluation = self._evaluation.Eval(context)
        if evaluation.action.sequence > marks[_SEEN]:
            marks[_SEEN] = evaluation.action.sequence
            if marks[_SEEN] == marks[_BEGUN] and evaluation.outcome is Outcome.SUCCESS:
                state = self._after_leg(context, state, marks, evaluation)
        action: Action = self._action.Eval(context)
        if action.kind is ActionKind.MOVE and action.sequence > marks[_BEGUN]:
            marks[_BEGUN], marks[_CARRYING] = action.sequence, bool(self._magnet.Eval(context).held)
            marks[_BEGAN], marks[_TARGET] = self._robot_state.Eval(context), self._target(context, action.place)
        discrete_state.set_value(np.append(state, marks))

    def _target(self, context: Context, place: str) -> tuple[float, float, float]:
        """The pose that the controller drives to for a place, (0, 0, 0) for one that is not known."""
        x, y, yaw = self._targets.get(place, (0.0, 0.0, 0.0))
        if not self._learned_targets.HasValue(context):
            return x, y, yaw
        told: LearnedTargets = self._learned_targets.Eval(context)
        return next(((tx, ty, yaw) for name, tx, ty in told.targets if name == place), (x, y, yaw))

    def _after_leg(
        self, context: Context, state: FloatArray, marks: FloatArray, evaluation: ActionEvaluation
    ) -> FloatArray:
        """The learners' state after a leg that has ended well."""
        leg = evaluation.action
        if leg.place not in self._targets:
            return state
        seen: Obstacles = self._obstacles.Eval(context)
        preferences: Preferences = self._preferences.Eval(context)
        known = self._learned_dynamics.HasValue(context)
        x, y, yaw = marks[_TARGET].tolist()
        try:
            gradient = self._gradient(
                marks[_BEGAN],
                (x, y, yaw),
                seen.shapes,
                action=leg,
                carrying=bool(marks[_CARRYING]),
                weights=preferences.estimate,
                prices=evaluation.prices,
                learned=self._learned(context),
                dynamics=self._learned_dynamics.Eval(context) if known else LearnedDynamics(),
            )
        except RuntimeError as error:
            _logger.info("no weights are learned from the leg to %s: simulated, it %s", leg.place, error)
            return state
        factors, gains = np.split(state, [self._split])
        if self._weights is not None:
            factors = self._weights.update(factors, leg.place, evaluation.cost_mismatch, gradient)
        if self._translation is not None:
            gains = self._translation.update(gains, preferences.estimate, evaluation.cost_mismatch, gradient)
        return np.concatenate((factors, gains))
