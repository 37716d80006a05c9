"""The feature meter: what an episode really cost, with the definitions that the planner predicts by."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydrake.common.containers import namedview
from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector, Context, DiscreteValues, LeafSystem

from mala_drake.clock import METER_OFFSET, TICK
from mala_drake.errors import BadInput
from mala_drake.messages import Action, ActionFeatures, ActionKind, EpisodeReport, Task, TaskReport
from mala_drake.randomness import keyed_generator
from mala_drake.robot.action_marks import SUMMED, ActionMarks, mark_action
from mala_drake.robot.plant_state import PLANT_STATE_SIZE, X, Y, yaw_of
from mala_drake.ward.congestion import sample
from mala_drake.ward.dishes import presentation_error
from mala_drake.ward.features import (
    FEATURE_SCALES,
    FEATURES,
    IDEAL_HAND_OVER,
    FeatureRates,
    FeatureScales,
    approach_error,
    worst_approach_error,
)
from mala_drake.ward.in_place_actions import DELIVERING, InPlaceAction, in_place_action
from mala_drake.ward.ward_map import Ward

FASTEST = 3.0
"""Metres per second; a robot that got somewhere faster was carried, and that is nobody's driving."""

_NAME = "feature_meter"


class _Numbers(NamedTuple):
    """The sums as plain numbers, to read many of them at every tick."""

    task: float  # Sequence of the task that is measured, 0 before the first one.
    closed: float  # 1 once it is finished.
    risk_scale: float  # Of the congestion that there really is, to that of the map.
    duration: float  # Seconds.
    risk: float
    charge_used: float
    discomfort: float
    approach_error: float  # Of the newest hand-over; the worst before there is one.
    begun: float  # Time at which it began, seconds.
    charge_at_start: float
    charge: float  # At the newest tick, like the position.
    x: float
    y: float


_Sums = namedview("_Sums", list(_Numbers._fields))


class FeatureMeter(LeafSystem):
    """Sums up time, risk, charge, discomfort and approach error of the task that is under way.

    .. pydrake_system::

        name: FeatureMeter
        input_ports:
        - task
        - task_report
        - action
        - plant_state
        - charge
        output_ports:
        - features
        - episode_report
        - action_features

    `features` are (time, safety, battery, proximity, approach) so far, each divided by its scale and cut to [0, 1].
    `episode_report` is empty (sequence 0) until the task is finished, and again once the next one begins.
    `action_features` are those of the newest action that has ended, unscaled, as long as the task report names it as
    the last one.

    `plant_state` is the robot's own state port (see `mala_drake.robot.plant_state`), not what the robot believes: the
    noise of an estimate is nobody's driving. Between two ticks the robot is taken to drive straight, at constant speed,
    and the rates of `mala_drake.ward.features` are integrated along the chord. Charge that a charger gives back is not
    counted as negative use. The approach error is that of the pose from which things are handed over. A state that is
    not finite, or farther away than the robot can have driven, adds time but no driving.

    The ward may be busier on one day than on another, which nobody knows beforehand: then the risk of each episode is
    that of the map times a number that depends on the seed and the episode.
    """

    def __init__(
        self,
        ward: Ward,
        *,
        scales: Mapping[str, FeatureScales] = FEATURE_SCALES,
        ideal: tuple[float, float, float] = IDEAL_HAND_OVER,
        risk_variation: float = 0.0,
        seed: int = 0,
    ) -> None:
        """Constructs the meter.

        Args:
            ward: the map.
            scales: what counts as 1, by the name of the task; tasks not named have the default scales.
            ideal: the pose (x, y, yaw) from which the patient would like things to be handed over.
            risk_variation: v in [0, 1]: the risk is scaled by U(1 - v, 1 + v) in each episode.
            seed: of the run.

        Raises:
            BadInput: if the variation is not in [0, 1] or the seed is negative.
        """
        super().__init__()
        self._rates = FeatureRates(ward)
        self._scales = {name: value.as_array() for name, value in scales.items()}
        self._ideal = ideal
        if not 0.0 <= risk_variation <= 1.0:
            raise BadInput("world.risk_variation", str(risk_variation), "a number in [0, 1]")
        self._risk_variation = risk_variation
        keyed_generator(seed, 0, _NAME)  # Refuses a bad seed now rather than in the simulation.
        self._seed = seed
        self._task = self.DeclareAbstractInputPort("task", Value(Task()))
        self._task_report = self.DeclareAbstractInputPort("task_report", Value(TaskReport()))
        self._action = self.DeclareAbstractInputPort("action", Value(Action()))
        self._plant_state = self.DeclareVectorInputPort("plant_state", PLANT_STATE_SIZE)
        self._charge = self.DeclareVectorInputPort("charge", 1)
        self._sums = self.DeclareDiscreteState(_Sums.Zero()[:])
        self._marks = self.DeclareDiscreteState(ActionMarks.Zero()[:])
        ticket = {self.discrete_state_ticket(self._sums), self._task.ticket()}
        self.DeclareVectorOutputPort("features", len(FEATURES), self._calc_features, prerequisites_of_calc=ticket)
        self.DeclareAbstractOutputPort(
            "episode_report",
            lambda: Value(EpisodeReport()),
            self._calc_episode_report,
            prerequisites_of_calc=ticket | {self._task_report.ticket()},
        )
        self.DeclareAbstractOutputPort(
            "action_features",
            lambda: Value(ActionFeatures()),
            self._calc_action_features,
            prerequisites_of_calc={
                self.discrete_state_ticket(self._sums),
                self.discrete_state_ticket(self._marks),
                self._task_report.ticket(),
            },
        )
        self.DeclarePeriodicDiscreteUpdateEvent(TICK, METER_OFFSET, self._update)

    def _update(self, context: Context, discrete_state: DiscreteValues) -> None:
        sums = _Sums(discrete_state.get_mutable_value(self._sums))
        marks = ActionMarks(discrete_state.get_mutable_value(self._marks))
        task = self._task.Eval(context)
        if task.sequence != sums.task:
            self._begin(context, sums, task)
            marks[:] = 0.0
        elif task.sequence > 0 and not sums.closed:
            self._integrate(context, sums)
            report = self._task_report.Eval(context)
            sums.closed = float(report.finished and report.sequence == task.sequence)
        current = self._action.Eval(context).sequence
        mark_action(marks, sums, current=current, working=sums.task > 0 and not sums.closed)

    def _begin(self, context: Context, sums: Any, task: Task) -> None:
        sums[:] = 0.0
        sums.task = task.sequence
        sums.approach_error = worst_approach_error(task.name)
        generator = keyed_generator(self._seed, task.episode, _NAME)
        sums.risk_scale = 1.0 + self._risk_variation * generator.uniform(-1.0, 1.0)
        sums.begun = context.get_time()
        sums.charge_at_start = sums.charge = self._charge.Eval(context)[0]
        sums.x, sums.y, _ = self._pose(context)

    def _integrate(self, context: Context, sums: Any) -> None:
        before = _Numbers._make(sums[:].tolist())
        elapsed = context.get_time() - before.begun - before.duration
        x, y, yaw = self._pose(context)
        charge = self._charge.Eval(context).item()
        sums.duration = before.duration + elapsed
        if math.isfinite(charge):
            sums.charge_used = before.charge_used + max(0.0, before.charge - charge)
            sums.charge = charge
        if not math.isfinite(x + y + yaw):
            return
        came_from = before.x, before.y
        if not math.dist(came_from, (x, y)) <= FASTEST * elapsed:
            came_from = x, y
        middles, lengths = sample([came_from, (x, y)])
        speed = lengths.sum() / elapsed
        time = elapsed / len(lengths)  # All pieces of one chord are equally long.
        sums.risk = before.risk + before.risk_scale * self._rates.risk_rate(middles, speed).sum() * time
        sums.discomfort = before.discomfort + self._rates.discomfort_rate(middles, speed).sum() * time
        handing_over = _handing_over(self._action.Eval(context))
        if handing_over is not None:
            sums.approach_error = approach_error((x, y, yaw), self._ideal) + presentation_error(handing_over.dish)
        sums.x, sums.y = x, y

    def _pose(self, context: Context) -> tuple[float, float, float]:
        """Where the robot is: x and y in metres, yaw in radians."""
        plant_state = self._plant_state.Eval(context).tolist()
        return plant_state[X], plant_state[Y], yaw_of(plant_state)

    def _features(self, sums: Any, task: str) -> NDArray[np.float64]:
        measured = np.array([sums.duration, sums.risk, sums.charge_used, sums.discomfort, sums.approach_error])
        scales = self._scales.get(task)
        return np.clip(measured / (FeatureScales().as_array() if scales is None else scales), 0.0, 1.0)

    def _calc_features(self, context: Context, output: BasicVector) -> None:
        sums = _Sums(context.get_discrete_state(self._sums).value())
        output.SetFromVector(self._features(sums, self._task.Eval(context).name))

    def _calc_episode_report(self, context: Context, output: Value) -> None:
        sums = _Sums(context.get_discrete_state(self._sums).value())
        task, report = self._task.Eval(context), self._task_report.Eval(context)
        if not sums.closed or task.sequence != sums.task or report.sequence != sums.task:
            output.set_value(EpisodeReport())
            return
        output.set_value(
            EpisodeReport(
                sequence=task.sequence,
                task=task.name,
                success=report.success,
                failure=report.failure,
                actions=report.actions,
                features=tuple(self._features(sums, task.name).tolist()),
                predicted_features=report.predicted_features,
                plan_cost=report.plan_cost,
                replans=report.replans,
                mismatches=report.mismatches,
                duration=float(sums.duration),
                battery_start=float(sums.charge_at_start),
                battery_end=float(sums.charge),
            )
        )

    def _calc_action_features(self, context: Context, output: Value) -> None:
        marks = ActionMarks(context.get_discrete_state(self._marks).value())
        report: TaskReport = self._task_report.Eval(context)
        action = report.last_action
        if action.sequence == 0 or action.sequence != marks.finished:
            output.set_value(ActionFeatures())
            return
        sums = _Sums(context.get_discrete_state(self._sums).value())
        handing_over = _handing_over(action)
        pose_error = 0.0 if handing_over is None else sums.approach_error - presentation_error(handing_over.dish)
        measured = {name: float(getattr(marks, name)) for name in SUMMED}
        output.set_value(ActionFeatures(action, report.last_outcome, approach_error=float(pose_error), **measured))


def _handing_over(action: Action) -> InPlaceAction | None:
    """The action if it hands something over, else None."""
    work = in_place_action(action.name, action.arguments) if action.kind is ActionKind.IN_PLACE else None
    return work if work is not None and work.verb in DELIVERING else None
