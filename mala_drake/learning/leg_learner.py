"""What the systems that learn from legs have in common: they remember how a leg was driven until they learn from it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pydrake.common.value import Value
from pydrake.systems.framework import Context, State

from mala_drake.clock import LEARN_OFFSET, TICK
from mala_drake.learning.learner_system import LearnerSystem
from mala_drake.messages import (
    Action,
    ActionKind,
    DrivenLeg,
    LearnedDynamics,
    LearnedWeights,
    MagnetCommand,
    Message,
    Obstacles,
    Preferences,
)
from mala_drake.optional_input import told


@dataclass(frozen=True, slots=True)
class _Legs(Message):
    """The newest leg and the one before it, as they began."""

    newest: DrivenLeg = DrivenLeg()
    before: DrivenLeg = DrivenLeg()


class LegLearner(LearnerSystem):
    """A system that has legs simulated as they were driven, to learn from them.

    It takes down how a leg begins, in the tick in which the controller accepts it: the state, the target, the learned
    weights and what the gripper holds. What the sensor sees, the preferences and the dynamics are those of the moment
    in which a leg is asked for. Since a leg may be evaluated in the tick in which the next one begins, two of them are
    remembered. `learned_dynamics` need not be connected.
    """

    def _declare_legs(self) -> None:
        """Declares the inputs that tell how legs are driven, and the state that remembers it."""
        self._action = self.DeclareAbstractInputPort("action", Value(Action()))
        self._robot_state = self.DeclareVectorInputPort("robot_state", 6)
        self._obstacles = self.DeclareAbstractInputPort("obstacles", Value(Obstacles()))
        self._magnet = self.DeclareAbstractInputPort("magnet", Value(MagnetCommand()))
        self._preferences = self.DeclareAbstractInputPort("preferences", Value(Preferences()))
        self._learned_dynamics = self.DeclareAbstractInputPort("learned_dynamics", Value(LearnedDynamics()))
        self._legs = self.DeclareAbstractState(Value(_Legs()))
        # Learners update discrete state, which at one instant comes later. So what a leg that is over has taught is not
        # yet among the weights of the one that has just begun, as the controller has not been told it either.
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, LEARN_OFFSET, self._note_leg)

    def _target(self, context: Context, place: str) -> tuple[float, float, float]:
        """The pose that the controller is to drive to for a place, whatever it is for one that is not known."""
        raise NotImplementedError

    def _weights_told(self, context: Context) -> LearnedWeights:
        """What the controller is told of its weights."""
        raise NotImplementedError

    def _note_leg(self, context: Context, state: State) -> None:
        action: Action = self._action.Eval(context)
        legs: _Legs = context.get_abstract_state(self._legs).get_value()
        if action.kind is not ActionKind.MOVE or action.sequence <= legs.newest.action.sequence:
            return
        leg = DrivenLeg(
            action=action,
            initial_state=tuple(self._robot_state.Eval(context).tolist()),
            target=self._target(context, action.place),
            carrying=bool(self._magnet.Eval(context).held),
            weights=self._weights_told(context),
        )
        state.get_mutable_abstract_state(self._legs).set_value(_Legs(leg, legs.newest))

    def _newest_leg(self, context: Context) -> DrivenLeg:
        """The leg that has begun last, be it under way or over; one with no place if there was none."""
        legs: _Legs = context.get_abstract_state(self._legs).get_value()
        return self._completed(context, legs.newest)

    def _leg_of(self, context: Context, action: Action) -> DrivenLeg | None:
        """The leg of an action, None if it is none of the last two."""
        legs: _Legs = context.get_abstract_state(self._legs).get_value()
        for leg in (legs.newest, legs.before):
            if leg.action.sequence == action.sequence > 0:
                return self._completed(context, leg)
        return None

    def _completed(self, context: Context, leg: DrivenLeg) -> DrivenLeg:
        """A leg with what is only known as it is driven."""
        return replace(
            leg,
            obstacles=self._obstacles.Eval(context).shapes,
            preferences=self._preferences.Eval(context).estimate,
            dynamics=told(self._learned_dynamics, context, LearnedDynamics()),
        )
