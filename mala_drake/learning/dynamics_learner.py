"""The dynamics learner as a system: how the robot answers its controls in, the controller's model out."""

from __future__ import annotations

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import Context, DiscreteValues, LeafSystem

from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE
from mala_drake.learning.abstract_learner import FloatArray
from mala_drake.learning.dynamics_estimator import DynamicsEstimator, Transition
from mala_drake.messages import LearnedDynamics

_LOG_SIZE = STATE_SIZE + CONTROL_SIZE + 1


class DynamicsLearner(LeafSystem):
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
        index = self.DeclareDiscreteState(np.concatenate((learner.initial_state(), np.zeros(_LOG_SIZE))))
        self.DeclareAbstractOutputPort(
            "learned_dynamics",
            lambda: Value(LearnedDynamics()),
            self._calc_learned_dynamics,
            prerequisites_of_calc={self.discrete_state_ticket(index)},
        )
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._update)

    def learner_state(self, context: Context) -> FloatArray:
        """The learner's state in `context`, for a checkpoint."""
        vector: FloatArray = context.get_discrete_state_vector().value()
        return vector[:-_LOG_SIZE].copy()

    def set_learner_state(self, context: Context, state: FloatArray, *, episode: int) -> None:  # noqa: ARG002
        """Puts what was learned before into `context`, in which the robot has not moved yet.

        Args:
            context: of this system.
            state: of the learner, as `learner_state` gave it.
            episode: the number of the next one; the robot is the same in all.
        """
        context.SetDiscreteState(np.concatenate((state, np.zeros(_LOG_SIZE))))

    def _calc_learned_dynamics(self, context: Context, output: Value) -> None:
        output.set_value(self._learner.learned(self.learner_state(context)))

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        log: FloatArray = context.get_discrete_state_vector().value()[-_LOG_SIZE:]
        before, control, begun = np.split(log, np.cumsum([STATE_SIZE, CONTROL_SIZE]))
        state = self.learner_state(context)
        now = np.array(self._robot_state.Eval(context))
        if begun.item() == 1.0:
            state = self._learner.update(state, Transition(before, control, now))
        discrete_state.set_value(np.concatenate((state, now, self._control.Eval(context), [1.0])))
