"""The cost learner as a system: what actions really cost in, corrected predictions out."""

from __future__ import annotations

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import Context, DiscreteValues

from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.learning.cost_estimator import CostEstimator
from mala_drake.learning.learner_system import LearnerSystem
from mala_drake.messages import ActionFeatures, LearnedCosts
from mala_drake.ward.cost_parameters import observed_parameters


class CostLearner(LearnerSystem):
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
        self._declare_learned("learned_costs", LearnedCosts(), initial_state=learner.initial_state(), marks=1)
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._update)

    def _learned(self, context: Context) -> LearnedCosts:
        return self._learner.learned(self.learner_state(context))

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        features: ActionFeatures = self._action_features.Eval(context)
        if features.action.sequence > self._marks(context).item():
            state = self._learner.update(self.learner_state(context), observed_parameters(features))
            discrete_state.set_value(np.append(state, float(features.action.sequence)))
