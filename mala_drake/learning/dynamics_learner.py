"""The dynamics learner as a system: how the robot answers its controls in, the controller's model out."""

from __future__ import annotations

import numpy as np
from pydrake.systems.framework import Context, DiscreteValues

from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE
from mala_drake.learning.dynamics_estimator import DynamicsEstimator, Transition
from mala_drake.learning.learner_system import LearnerSystem
from mala_drake.messages import LearnedDynamics

_LOG_SIZE = STATE_SIZE + CONTROL_SIZE + 1


class DynamicsLearner(LearnerSystem):
    """Learns the coefficients of the controller's model, once a tick, from what the tick before did.

    .. pydrake_system::

        name: DynamicsLearner
        input_ports:
        - robot_state
        - control
        output_ports:
        - learned_dynamics

    `learned_dynamics` is a `LearnedDynamics`. The discrete state is the learner's own vector followed by the log that
    the next sample needs: the robot state and the control of the last tick, and 1 if there was one, else 0. The log
    begins anew with every episode.
    """

    def __init__(self, *, learner: DynamicsEstimator) -> None:
        """Constructs the system around a learner that has learned nothing yet."""
        super().__init__()
        self._learner = learner
        self._robot_state = self.DeclareVectorInputPort("robot_state", STATE_SIZE)
        self._control = self.DeclareVectorInputPort("control", CONTROL_SIZE)
        self._declare_learned(
            "learned_dynamics", LearnedDynamics(), initial_state=learner.initial_state(), marks=_LOG_SIZE
        )
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._update)

    def _learned(self, context: Context) -> LearnedDynamics:
        return self._learner.learned(self.learner_state(context))

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        before, control, begun = np.split(self._marks(context), np.cumsum([STATE_SIZE, CONTROL_SIZE]))
        state = self.learner_state(context)
        now = np.array(self._robot_state.Eval(context))
        if begun.item() == 1.0:
            state = self._learner.update(state, Transition(before, control, now))
        discrete_state.set_value(np.concatenate((state, now, self._control.Eval(context), [1.0])))
