"""What all systems that learn have in common: what is learned is discrete state, and outlives the episode."""

from __future__ import annotations

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import Context, LeafSystem

from mala_drake.learning.abstract_learner import FloatArray
from mala_drake.messages import Message


class LearnerSystem(LeafSystem):
    """A system around a learner: it keeps the learner's state and says on a port what is learned.

    Its discrete state is the learner's own vector followed by marks: numbers that the system itself remembers from one
    tick to the next, and that begin at 0 in every episode unless a system has another beginning for them.
    """

    def _declare_learned(self, port: str, nothing: Message, *, initial_state: FloatArray, marks: int) -> None:
        """Declares the state, and the output port that `_learned` computes from it.

        Args:
            port: its name.
            nothing: the model value of the port.
            initial_state: of the learner, shape (k,).
            marks: how many there are.
        """
        self._learner_size = initial_state.size
        self._marks_size = marks
        index = self.DeclareDiscreteState(np.append(initial_state, np.zeros(marks)))
        self.DeclareAbstractOutputPort(
            port,
            lambda: Value(nothing),
            self._calc_learned,
            prerequisites_of_calc={self.discrete_state_ticket(index)},
        )

    def learner_state(self, context: Context) -> FloatArray:
        """The learner's state in `context`, shape (k,), for a checkpoint."""
        vector: FloatArray = context.get_discrete_state_vector().value()
        return vector[: self._learner_size].copy()

    def set_learner_state(self, context: Context, state: FloatArray, *, episode: int) -> None:  # noqa: ARG002
        """Puts what was learned before into `context`, in which nothing has happened yet.

        Args:
            context: of this system.
            state: of the learner, as `learner_state` gave it.
            episode: the number of the next one; most learners learn in all alike.
        """
        context.SetDiscreteState(np.append(state, np.zeros(self._marks_size)))

    def _marks(self, context: Context) -> FloatArray:
        """The marks in `context`."""
        vector: FloatArray = context.get_discrete_state_vector().value()
        return vector[self._learner_size :].copy()

    def _learned(self, context: Context) -> Message:
        """What is learned, for the output port."""
        raise NotImplementedError

    def _calc_learned(self, context: Context, output: Value) -> None:
        output.set_value(self._learned(context))
