"""The preference learner as a system: ratings in, preference weights out."""

from __future__ import annotations

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.framework import Context, DiscreteValues

from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.errors import BadInput
from mala_drake.learning.abstract_preference_learner import AbstractPreferenceLearner, FloatArray
from mala_drake.learning.learner_system import LearnerSystem
from mala_drake.messages import Preferences, Ratings
from mala_drake.randomness import keyed_generator

_NAME = "preference_learner"


class PreferenceLearner(LearnerSystem):
    """Learns the patient's preference weights, once from the ratings of each episode.

    .. pydrake_system::

        name: PreferenceLearner
        input_ports:
        - ratings
        output_ports:
        - preferences

    The discrete state is the learner's own vector followed by the sequence number of the last ratings seen. The
    planning weights are a function of it: their exploration noise comes from the generator of the episode they are
    for (the one after the last ratings seen), so a learner restored at any episode, in a new system or in a fresh
    context of this one, goes on as if it had never stopped.
    """

    def __init__(self, *, learner: AbstractPreferenceLearner, seed: int = 0) -> None:
        """Constructs the system around a learner that has learned nothing yet.

        Args:
            learner: what learns.
            seed: of the run.

        Raises:
            BadInput: if the seed is negative.
        """
        super().__init__()
        self._learner = learner
        self._seed = seed
        keyed_generator(seed, 0, _NAME)  # Refuses a bad seed now rather than in the simulation.
        # What was computed last, and from which state: a pure function's memory, not state.
        self._newest: tuple[bytes, Preferences] = (b"", Preferences())
        self._ratings = self.DeclareAbstractInputPort("ratings", Value(Ratings()))
        self._declare_learned("preferences", Preferences(), initial_state=learner.initial_state(), marks=1)
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, LEARN_OFFSET, self._update)

    def set_learner_state(self, context: Context, state: FloatArray, *, episode: int) -> None:
        """Puts what was learned before into `context`, in which `episode` is the next one.

        Args:
            context: of this system.
            state: of the learner, as `learner_state` gave it.
            episode: the number of the episode to plan now, >= 0; as many have been rated.

        Raises:
            BadInput: if the episode is negative.
        """
        if episode < 0:
            raise BadInput("episode", str(episode), "a number >= 0")
        context.SetDiscreteState(np.append(state, float(episode)))

    def seen(self, context: Context) -> int:
        """Sequence number of the last ratings taken in, 0 before the first."""
        return int(self._marks(context).item())

    def _learned(self, context: Context) -> Preferences:
        # The update leaves the state as it is at nearly every tick, but the port is asked anew after each.
        key = context.get_discrete_state_vector().value().tobytes()
        if key != self._newest[0]:
            self._newest = (key, self._preferences(context))
        return self._newest[1]

    def _preferences(self, context: Context) -> Preferences:
        state = self.learner_state(context)
        generator = keyed_generator(self._seed, self.seen(context), _NAME)
        deviation = self._learner.deviation(state)
        return Preferences(
            planning=tuple(self._learner.planning_weights(state, generator).tolist()),
            estimate=tuple(self._learner.estimate(state).tolist()),
            deviation=None if deviation is None else tuple(deviation.tolist()),
            updates=self._learner.updates(state),
        )

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        ratings = self._ratings.Eval(context)
        if ratings.sequence > self.seen(context):
            state = self._learner.update(self.learner_state(context), ratings=ratings.values, features=ratings.features)
            discrete_state.set_value(np.append(state, float(ratings.sequence)))
