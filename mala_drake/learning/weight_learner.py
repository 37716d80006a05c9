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
from mala_drake.learning.leg_learner import LegLearner
from mala_drake.learning.translation_estimator import TranslationEstimator
from mala_drake.learning.weight_estimator import WeightEstimator
from mala_drake.messages import ActionEvaluation, DrivenLeg, LearnedTargets, LearnedWeights, Outcome
from mala_drake.optional_input import told

_logger = logging.getLogger(__name__)

_NOTHING = np.zeros(0)  # The state of what is not learned.


class CostGradient(Protocol):
    """Who knows how the cost of a leg moves with its weights."""

    def __call__(self, leg: DrivenLeg, *, prices: Sequence[float]) -> FloatArray:
        """D cost / d log of the diagonal entries of Q and R, shape (9,).

        Raises:
            RuntimeError: there is no such derivative; says why.
        """


class WeightLearner(LegLearner):
    """Learns what is to cost the controller, once from each leg that has ended well.

    .. pydrake_system::

        name: WeightLearner
        input_ports:
        - action
        - robot_state
        - obstacles
        - magnet
        - preferences
        - learned_dynamics
        - action_evaluation
        - learned_targets
        output_ports:
        - learned_weights

    Factors of the weights by the place that a leg leads to (p^g), the translation from preferences to weights, or both
    move along the gradient of the leg's cost, such that the mismatch E^C falls. For it the leg is simulated in closed
    loop over the controller's model, as it began and with the weights that it began with. `learned_targets` and
    `learned_dynamics` are what the controller is told, where they are connected.

    A leg that failed, or whose cost has no derivative, teaches nothing. The discrete state is the vectors of both
    learners and the sequence of the last evaluation; the abstract state is what is known of the last legs.
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
        self._declare_legs()
        self._evaluation = self.DeclareAbstractInputPort("action_evaluation", Value(ActionEvaluation()))
        self._learned_targets = self.DeclareAbstractInputPort("learned_targets", Value(LearnedTargets()))
        factors = _NOTHING if weights is None else weights.initial_state()
        gains = _NOTHING if translation is None else translation.initial_state()
        self._split = factors.size
        self._declare_learned("learned_weights", LearnedWeights(), initial_state=np.append(factors, gains), marks=1)
        # The action meter's update is unrestricted, this one discrete: it hears of an action in the same instant.
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._update)

    def _learned(self, context: Context) -> LearnedWeights:
        factors, gains = np.split(self.learner_state(context), [self._split])
        return LearnedWeights(
            () if self._weights is None else self._weights.learned(factors),
            () if self._translation is None else self._translation.learned(gains),
        )

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        state, (seen,) = self.learner_state(context), self._marks(context)
        evaluation: ActionEvaluation = self._evaluation.Eval(context)
        if evaluation.action.sequence > seen:
            seen = evaluation.action.sequence
            leg = self._leg_of(context, evaluation.action)
            if leg is not None and leg.action.place in self._targets and evaluation.outcome is Outcome.SUCCESS:
                state = self._after_leg(state, leg, evaluation)
        discrete_state.set_value(np.append(state, seen))

    def _target(self, context: Context, place: str) -> tuple[float, float, float]:
        """The pose that the controller drives to for a place, (0, 0, 0) for one that is not known."""
        pose = self._targets.get(place, (0.0, 0.0, 0.0))
        return told(self._learned_targets, context, LearnedTargets()).pose(place, pose)

    def _weights_told(self, context: Context) -> LearnedWeights:
        return self._learned(context)

    def _after_leg(self, state: FloatArray, leg: DrivenLeg, evaluation: ActionEvaluation) -> FloatArray:
        """The learners' state after a leg that has ended well."""
        try:
            gradient = self._gradient(leg, prices=evaluation.prices)
        except RuntimeError as error:
            _logger.info("no weights are learned from the leg to %s: simulated, it %s", leg.action.place, error)
            return state
        factors, gains = np.split(state, [self._split])
        if self._weights is not None:
            factors = self._weights.update(factors, leg.action.place, evaluation.cost_mismatch, gradient)
        if self._translation is not None:
            gains = self._translation.update(gains, leg.preferences, evaluation.cost_mismatch, gradient)
        return np.concatenate((factors, gains))
