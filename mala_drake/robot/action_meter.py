"""The action meter: what each executed action was worth, and how far it was from what was expected."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.systems.framework import Context, LeafSystem, State

from mala_drake.clock import PATIENT_OFFSET, TICK
from mala_drake.messages import (
    Action,
    ActionEvaluation,
    ActionFeatures,
    ActionKind,
    ActionReport,
    Message,
    Outcome,
    PlaceMismatch,
    Preferences,
    Task,
    TaskReport,
)
from mala_drake.ward.dishes import presentation_error
from mala_drake.ward.features import FEATURE_SCALES, IDEAL_HAND_OVER, FeatureScales, approach_error
from mala_drake.ward.in_place_actions import Verb, in_place_action


@dataclass(frozen=True, slots=True)
class _Evaluating(Message):
    """The meter's state: what is known of the action under way, and the newest one that has ended."""

    action: Action = Action()
    weights: tuple[float, ...] = (0.2,) * 5
    place_error: float = 1.0
    approach_error: float = 0.0
    closed_loop_cost: float | None = None
    ended: ActionEvaluation = ActionEvaluation()


class ActionMeter(LeafSystem):
    """Evaluates each executed action (paper, Sec. "Updating the Planning State and Model" and the one after it).

    .. pydrake_system::

        name: ActionMeter
        input_ports:
        - task
        - task_report
        - action
        - leg_report
        - in_place_report
        - place_mismatch
        - robot_state
        - preferences
        - action_features
        output_ports:
        - action_evaluation

    `action_evaluation` is that of the newest action that has ended, well or badly, from the tick on in which the
    planner has drawn its consequences:

    - R^e, the external reward: what the patient thinks of the action's features, -w' f_measured, with the preferences w
      that it was planned with.
    - R^o, of a leg: its closed-loop cost, W of the reached state and the sum of G over the steps.
    - E^psi, the state mismatch: 1 - mu of being where the action was to lead, at the reached state; 1 if another
      atom is not as expected. It is 0 when the state is the expected one without a doubt.
    - E^C, the cost mismatch: w' f_measured - w' f_predicted, by the planner's prediction at dispatch.

    The paper's E^C = R - C_bar mixes a reward with a cost. Here it is a difference of costs, positive if the action
    cost more than predicted; who learns from it goes by that sign. Features are scaled as in episodes, but not cut. As
    in the planning domains, the approach error belongs to the leg to the bedside, of the pose that it ends in, and the
    looks of a dish to its assembling.

    The events of one tick: at the executors' moments an action ends; at the planner's, a tick later, the next one
    begins. What an action has come to is therefore taken down when its report says that it has ended, and kept until
    the planner has drawn the consequences.
    """

    def __init__(
        self,
        *,
        bedsides: Collection[str],
        scales: Mapping[str, FeatureScales] = FEATURE_SCALES,
        ideal: tuple[float, float, float] = IDEAL_HAND_OVER,
    ) -> None:
        """Constructs the meter.

        Args:
            bedsides: the places from which things are handed over.
            scales: what counts as 1, by the name of the task; tasks not named have the default scales.
            ideal: the pose (x, y, yaw) from which the patient would like things to be handed over.
        """
        super().__init__()
        self._bedsides = frozenset(bedsides)
        self._ideal = ideal
        self._scales = dict(scales)
        self._task = self.DeclareAbstractInputPort("task", Value(Task()))
        self._task_report = self.DeclareAbstractInputPort("task_report", Value(TaskReport()))
        self._action = self.DeclareAbstractInputPort("action", Value(Action()))
        self._leg_report = self.DeclareAbstractInputPort("leg_report", Value(ActionReport()))
        self._in_place_report = self.DeclareAbstractInputPort("in_place_report", Value(ActionReport()))
        self._place_mismatch = self.DeclareAbstractInputPort("place_mismatch", Value(PlaceMismatch()))
        self._robot_state = self.DeclareVectorInputPort("robot_state", 6)
        self._preferences = self.DeclareAbstractInputPort("preferences", Value(Preferences()))
        self._action_features = self.DeclareAbstractInputPort("action_features", Value(ActionFeatures()))
        self._evaluating = self.DeclareAbstractState(Value(_Evaluating()))
        self.DeclareAbstractOutputPort(
            "action_evaluation",
            lambda: Value(ActionEvaluation()),
            self._calc_action_evaluation,
            prerequisites_of_calc={self.abstract_state_ticket(self._evaluating)},
        )
        # After the feature meter, before the learners, while the preferences are still those of the action.
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, PATIENT_OFFSET, self._update)

    def _state(self, context: Context) -> _Evaluating:
        return context.get_abstract_state(self._evaluating).get_value()

    def _calc_action_evaluation(self, context: Context, output: Value) -> None:
        output.set_value(self._state(context).ended)

    def _update(self, context: Context, state: State) -> None:
        before = self._state(context)
        after = self._under_way(context, self._ended(context, before))
        if after is not before:
            state.get_mutable_abstract_state(self._evaluating).set_value(after)

    def _ended(self, context: Context, state: _Evaluating) -> _Evaluating:
        """With the evaluation of the action that was under way, if the feature meter says what it took."""
        sequence = state.action.sequence
        report: TaskReport = self._task_report.Eval(context)
        if report.last_action.sequence != sequence or sequence <= state.ended.action.sequence:
            return state
        features: ActionFeatures = self._action_features.Eval(context)
        if features.action.sequence != sequence:
            return state
        weights = np.array(state.weights)
        scales = self._scales.get(self._task.Eval(context).name, FeatureScales()).as_array()
        cost = float(weights @ (_measured(features, state.approach_error) / scales))
        elsewhere = any(atom[0] != "at" for atom in report.last_differing)
        evaluation = ActionEvaluation(
            features.action,
            features.outcome,
            state.weights,
            prices=tuple((weights / scales).tolist()),
            external_reward=-cost,
            closed_loop_cost=state.closed_loop_cost,
            state_mismatch=1.0 if elsewhere else state.place_error,
            cost_mismatch=cost - float(weights @ np.array(report.last_predicted)),
        )
        return replace(state, ended=evaluation)

    def _under_way(self, context: Context, state: _Evaluating) -> _Evaluating:
        """With what is known now of the action that has not ended yet."""
        action: Action = self._action.Eval(context)
        if action.sequence == state.ended.action.sequence:
            return state
        if action.sequence != state.action.sequence:
            preferences: Preferences = self._preferences.Eval(context)
            state = _Evaluating(action, preferences.planning, ended=state.ended)
        is_leg = action.kind is ActionKind.MOVE
        report: ActionReport = (self._leg_report if is_leg else self._in_place_report).Eval(context)
        if report.sequence != action.sequence or not report.finished:
            return state
        mismatch: PlaceMismatch = self._place_mismatch.Eval(context)
        return replace(
            state,
            # Where the robot's place is not known it is not the expected one.
            place_error=mismatch.error if mismatch.place == action.place else 1.0,
            closed_loop_cost=report.closed_loop_cost if is_leg else None,
            approach_error=self._approach_error(context, action),
        )

    def _approach_error(self, context: Context, action: Action) -> float:
        """That of the pose which a leg to a bedside has come to; 0 of any other action."""
        if action.kind is not ActionKind.MOVE or action.place not in self._bedsides:
            return 0.0
        x, y, yaw = self._robot_state.Eval(context)[:3].tolist()
        return approach_error((x, y, yaw), self._ideal) if math.isfinite(x + y + yaw) else 0.0


def _measured(features: ActionFeatures, approach: float) -> NDArray[np.float64]:
    """The five features of an action, unscaled."""
    work = in_place_action(features.action.name, features.action.arguments)
    assembled = work.dish if work is not None and work.verb is Verb.ASSEMBLE else ""
    done = features.outcome is Outcome.SUCCESS  # What was not done has neither approached nor assembled anything.
    last = approach + presentation_error(assembled) if done else 0.0
    return np.array([features.duration, features.risk, features.charge_used, features.discomfort, last])
