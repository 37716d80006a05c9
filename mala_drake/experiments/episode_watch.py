"""Looks at the ports of a running station once a tick and keeps what an episode's record needs."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from pydrake.systems.framework import Context, Diagram

from mala_drake.control.parameters import DynamicsParameters
from mala_drake.control_learners import dynamics_estimator
from mala_drake.experiments.displaced_legs import DisplacedLegs
from mala_drake.experiments.episode_record import EpisodeRecord, by_criterion, plan_variant, timing
from mala_drake.experiments.model_errors import ModelErrors
from mala_drake.learning.convergence import preference_distance
from mala_drake.messages import (
    Action,
    ActionEvaluation,
    ActionKind,
    ActionReport,
    EpisodeReport,
    LearnedDynamics,
    LearnedTargets,
    LearnedWeights,
    Outcome,
    PlaceMismatch,
    Preferences,
    Ratings,
    TaskReport,
)
from mala_drake.preferences import CRITERIA
from mala_drake.scenario import Scenario
from mala_drake.ward.in_place_actions import Verb, in_place_action


class EpisodeWatch:
    """Follows one episode. It only reads ports: watching does not change what happens."""

    def __init__(self, station: Diagram, context: Context, scenario: Scenario, episode: int) -> None:
        """Begins to watch the episode (counted from 0) that `context` is set up for."""
        self._station = station
        self._context = context
        self._ports: dict[tuple[str, str], tuple[Any, Context]] = {}  # Those read so far, with their contexts.
        self._scenario = scenario
        self._episode = episode
        self._started = context.get_time()
        self._controller: Any = station.GetSubsystemByName("mpc_controller")
        self._planner: Any = station.GetSubsystemByName("task_planner")
        self._solves = len(self._controller.solve_seconds)
        self._plans = len(self._planner.solve_seconds)
        self._action = Action()
        self._actions: list[str] = []
        self._evaluations: list[ActionEvaluation] = []
        self._legs: list[ActionReport] = []
        self._out_of_reach = 0  # Sequence of the last action whose things were.
        self._displaced_legs = DisplacedLegs(scenario, self._learned_targets())
        learns_dynamics = station.HasSubsystemNamed("dynamics_learner")
        self._model_errors = ModelErrors(dynamics_estimator(scenario)) if learns_dynamics else None
        self._before: Preferences = self._read("preference_learner", "preferences")
        self._charge_before = self._charge()

    def _read(self, system: str, port: str) -> Any:
        if (system, port) not in self._ports:
            subsystem = self._station.GetSubsystemByName(system)
            self._ports[system, port] = subsystem.GetOutputPort(port), subsystem.GetMyContextFromRoot(self._context)
        output, context = self._ports[system, port]
        return output.Eval(context)

    def _learned_targets(self) -> LearnedTargets:
        if not self._station.HasSubsystemNamed("target_learner"):
            return LearnedTargets()
        learned: LearnedTargets = self._read("target_learner", "learned_targets")
        return learned

    def _charge(self) -> float:
        return float(self._read("battery", "charge")[0])

    @property
    def finished(self) -> bool:
        """Whether the episode has been executed, rated and learned from."""
        ratings: Ratings = self._read("patient", "ratings")
        if ratings.sequence < self._episode + 1:
            return False
        learner: Any = self._station.GetSubsystemByName("preference_learner")
        return learner.seen(learner.GetMyContextFromRoot(self._context)) >= self._episode + 1

    def look(self) -> list[str]:
        """Takes in what has happened since the last look; returns what is new, for people."""
        news = []
        action: Action = self._read("task_planner", "action")
        if action.sequence > self._action.sequence:
            self._action = action
            self._actions.append(action.text)
            news.append(describe(action))
        report: ActionReport = self._read("mpc_controller", "leg_report")
        seen = self._legs[-1].sequence if self._legs else 0
        if report.finished and report.sequence > seen:
            self._legs.append(report)
            mismatch: PlaceMismatch = self._read("fuzzy_grounding", "place_mismatch")
            self._displaced_legs.add(self._action, report, mismatch, self._learned_targets())
            if report.outcome is not Outcome.SUCCESS:
                news.append(f"the leg ended: {report.outcome.value} ({report.detail})")
        self._look_at_reach()
        evaluation: ActionEvaluation = self._read("action_meter", "action_evaluation")
        if evaluation.action.sequence > (self._evaluations[-1].action.sequence if self._evaluations else 0):
            self._evaluations.append(evaluation)
        self._look_at_model()
        return news

    def _look_at_reach(self) -> None:
        report: ActionReport = self._read("in_place_executor", "in_place_report")
        if report.outcome is Outcome.OUT_OF_REACH and report.sequence > self._out_of_reach:
            self._out_of_reach = report.sequence
            mismatch: PlaceMismatch = self._read("fuzzy_grounding", "reach_mismatch")
            self._displaced_legs.add(self._action, report, mismatch, self._learned_targets())

    def _look_at_model(self) -> None:
        if self._model_errors is not None:
            self._model_errors.add(
                self._read("state_estimator", "robot_state"),
                self._read("mpc_controller", "control"),
                self._read("dynamics_learner", "learned_dynamics"),
            )

    def record(self, *, wall_seconds: float, cpu_seconds: float) -> EpisodeRecord:
        """The record of the episode, failed for lack of time when it has not finished."""
        report = self._report()
        ratings: Ratings = self._read("patient", "ratings")
        after: Preferences = self._read("preference_learner", "preferences")
        safety = self._read("safety_monitor", "safety")
        legs = [*self._legs, *self._leg_under_way()]
        task = report.task or self._scenario.task
        return EpisodeRecord(
            episode=self._episode,
            task=task,
            profile=self._scenario.profile_name,
            seed=self._scenario.random_seed,
            success=report.success,
            failure=None if report.success else (report.failure or "unknown"),
            actions=self._actions,
            plan_variant=plan_variant(self._actions, task),
            plan_cost=report.plan_cost,
            replans=report.replans,
            features=by_criterion(report.features),
            predicted_features=by_criterion(report.predicted_features),
            ratings=list(ratings.values) if ratings.sequence == self._episode + 1 else [None] * len(CRITERIA),
            weights_before=list(self._before.estimate),
            weights_after=list(after.estimate),
            weights_std=None if after.deviation is None else list(after.deviation),
            distance_to_true=preference_distance(after.estimate, self._scenario.true_weights_in(self._episode)),
            sim_time_s=self._context.get_time() - self._started,
            solver=self._scenario.control.solver,
            mpc_solves=sum(leg.solves for leg in legs),
            mpc_failures=sum(leg.failures for leg in legs),
            mpc_not_converged=sum(leg.not_converged for leg in legs),
            min_clearance_m=float(safety[0]),
            collisions=int(safety[1]),
            terminal_errors_m=[leg.position_error for leg in self._legs],
            terminal_yaw_errors_rad=[leg.yaw_error for leg in self._legs],
            terminal_speeds_m_s=[leg.terminal_speed for leg in self._legs],
            leg_outcomes=[leg.outcome.value for leg in self._legs],
            mismatches=report.mismatches,
            battery_start=self._charge_before,
            battery_end=self._charge(),
            learned_dynamics=self._learned_dynamics(),
            dynamics_errors=None if self._model_errors is None else self._model_errors.root_mean_squares(),
            learned_weights=self._learned_factors(),
            learned_translation=self._learned_gains(),
            executed_actions=[_entry(evaluation) for evaluation in self._evaluations],
            timing=timing(
                wall_seconds=wall_seconds,
                cpu_seconds=cpu_seconds,
                mpc_seconds=self._controller.solve_seconds[self._solves :],
                plan_seconds=self._planner.solve_seconds[self._plans :],
            ),
            displaced_legs=self._displaced_legs.entries,
        )

    def _report(self) -> EpisodeReport:
        """What became of the task; when it is still being worked on, what has come of it so far."""
        report: EpisodeReport = self._read("feature_meter", "episode_report")
        if report.sequence == self._episode + 1:
            return report
        unfinished: TaskReport = self._read("task_planner", "task_report")
        return EpisodeReport(
            task=self._read("scheduler", "task").name,
            failure="the time of the episode was up",
            features=tuple(self._read("feature_meter", "features")),
            predicted_features=unfinished.predicted_features,
            plan_cost=unfinished.plan_cost,
            replans=unfinished.replans,
            mismatches=unfinished.mismatches,
        )

    def _learned_dynamics(self) -> dict[str, list[float]] | None:
        """Estimate and standard deviation by coefficient, if the station has a learner of them."""
        if self._model_errors is None:
            return None
        learned: LearnedDynamics = self._read("dynamics_learner", "learned_dynamics")
        names = [item.name for item in fields(DynamicsParameters)]
        pairs = zip(learned.coefficients, learned.deviations, strict=True)
        return {name: list(pair) for name, pair in zip(names, pairs, strict=False)}

    def _learned_factors(self) -> dict[str, list[float]] | None:
        """Factors of the controller's weights by place, if the station learns them."""
        if not self._scenario.control.learned_weights:
            return None
        learned: LearnedWeights = self._read("weight_learner", "learned_weights")
        return {place: list(factors) for place, factors in learned.factors}

    def _learned_gains(self) -> list[list[float]] | None:
        """The gains from preferences to weights, if the station learns them; empty before the first leg."""
        if not self._scenario.control.learned_translation:
            return None
        learned: LearnedWeights = self._read("weight_learner", "learned_weights")
        return [list(row) for row in learned.gains]

    def _leg_under_way(self) -> list[ActionReport]:
        """The leg that the end of the episode's time cuts short, if there is one."""
        report: ActionReport = self._read("mpc_controller", "leg_report")
        return [report] if report.sequence > 0 and not report.finished else []


def _entry(evaluation: ActionEvaluation) -> dict[str, Any]:
    """An executed action, fit for JSON."""
    return {
        "action": evaluation.action.text,
        "outcome": evaluation.outcome.value,
        "external_reward": evaluation.external_reward,
        "closed_loop_cost": evaluation.closed_loop_cost,
        "state_mismatch": evaluation.state_mismatch,
        "cost_mismatch": evaluation.cost_mismatch,
    }


def describe(action: Action) -> str:
    """An action in words, with places spelled as on the map."""
    place = action.place.replace("_", " ")
    if action.kind is ActionKind.MOVE:
        return f"drive to {place}"
    work = in_place_action(action.name, action.arguments)
    name = action.name if work is None or work.verb is not Verb.COLLECT_INGREDIENT else f"collect_{work.kind}"
    words = name.replace("_", " ")
    return f"{words} at {place}" if place and "bedside" not in words else words
