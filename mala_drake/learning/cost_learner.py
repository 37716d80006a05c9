"""The cost learner as a system: what actions really cost in, corrected predictions out."""

from __future__ import annotations

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import Context, DiscreteValues, LeafSystem

from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.learning.abstract_learner import FloatArray
from mala_drake.learning.cost_estimator import CostEstimator
from mala_drake.messages import ActionFeatures, LearnedCosts
from mala_drake.ward.cost_parameters import observed_parameters


class CostLearner(LeafSystem):
    """Learns what actions cost, once from each action that has ended well.

    .. pydrake_system::

        name: CostLearner
        input_ports:
        - action_features
        output_ports:
        - learned_costs

    The discrete state is the learner's own vector followed by the sequence number of the last action seen.
    """

    def __init__(self, *, learner: CostEstimator) -> None:
        """Constructs the system around a learner that has learned nothing yet."""
        super().__init__()
        self._learner = learner
        self._action_features = self.DeclareAbstractInputPort("action_features", Value(ActionFeatures()))
        index = self.DeclareDiscreteState(np.append(learner.initial_state(), 0.0))
        self.DeclareAbstractOutputPort(
            "learned_costs",
            lambda: Value(LearnedCosts()),
            self._calc_learned_costs,
            prerequisites_of_calc={self.discrete_state_ticket(index)},
        )
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._update)

    def learner_state(self, context: Context) -> FloatArray:
        """The learner's state in `context`, for a checkpoint."""
        vector: FloatArray = context.get_discrete_state_vector().value()
        return vector[:-1].copy()

    def set_learner_state(self, context: Context, state: FloatArray, *, episode: int) -> None:  # noqa: ARG002
        """Puts what was learned before into `context`, in which no action has ended yet.

        Args:
            context: of this system.
            state: of the learner, as `learner_state` gave it.
            episode: the number of the next one; costs are learned in all alike.
        """
        context.SetDiscreteState(np.append(state, 0.0))

    def _calc_learned_costs(self, context: Context, output: Value) -> None:
        output.set_value(self._learner.learned(self.learner_state(context)))

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        features: ActionFeatures = self._action_features.Eval(context)
        seen = context.get_discrete_state_vector().GetAtIndex(discrete_state.value().size - 1)
        if features.action.sequence > seen:
            state = self._learner.update(self.learner_state(context), observed_parameters(features))
            discrete_state.set_value(np.append(state, float(features.action.sequence)))
