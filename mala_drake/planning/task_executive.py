"""The rules of closed-loop planning: plan from what is observed, do one action, look again (row L2).

s_t -> a_t = first action of the optimal plan from s_t at the current weights; after each action the observed state
replaces the predicted one, whatever the action's outcome was.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

from mala_drake.messages import ActionKind, ActionReport, Atom, LearnedCosts, Outcome, PlanMessage, SymbolicState, Task
from mala_drake.planning.care_tasks import CareTask
from mala_drake.planning.leg_costs import Pose
from mala_drake.planning.plan import Plan
from mala_drake.planning.planner import Planner
from mala_drake.planning.state import SymbolicState as PlannerState
from mala_drake.planning.task_progress import TaskProgress

_SAME_FAILURES = 3  # Of one action, after which its task has failed.
_MOST_WAITS = 25  # Ticks for the position to become known again.
_STATUS = {"optimal": "optimal", "unsolvable": "unsolvable", "timeout": "limit"}


@dataclass(frozen=True, slots=True)
class Situation:
    """What is known at one moment: the observed state, the robot's pose, weights to plan with and learned costs."""

    observed: SymbolicState
    pose: Pose
    weights: tuple[float, ...]
    learned: LearnedCosts = LearnedCosts()


class TaskExecutive:
    """Moves a `TaskProgress` on. It keeps nothing that a result depends on.

    Attributes:
        solve_seconds: wall time of each search so far, for the record only.
    """

    def __init__(self, tasks: Mapping[str, CareTask], *, max_actions: int, max_expansions: int) -> None:
        self._tasks = tasks
        self._planners = {name: Planner(task.planning_task) for name, task in tasks.items()}
        self._max_actions = max_actions
        self._max_expansions = max_expansions
        self.solve_seconds: list[float] = []
        # Grounding is slow and happens once, here: every replan is fast.
        for name, task in tasks.items():
            for state in task.typical_states():
                self._planners[name].solve(state, max_expansions=max_expansions)

    @property
    def predictions(self) -> dict[Atom, float]:
        """The fluents of all tasks that can be learned, as predicted from the map."""
        return {name: value for task in self._tasks.values() for name, value in task.predictions.items()}

    def begin(self, progress: TaskProgress, task: Task, situation: Situation) -> TaskProgress:
        """Takes up a new task, whatever was going on before."""
        progress = progress.begun(task, at=situation.observed.place)
        if task.name not in self._tasks:
            return progress.finished(failure=f"unknown task {task.name!r}")
        return self.proceed(progress, situation)

    def conclude(self, progress: TaskProgress, report: ActionReport, situation: Situation) -> TaskProgress:
        """Draws the consequences of a finished action, then plans and dispatches the next one."""
        care, action, observed = self._tasks[progress.task.name], progress.action, situation.observed
        differing = care.mismatch(progress.expected, observed) if progress.expected is not None else ()
        progress = progress.executed(
            report.outcome,
            differing=differing,
            standing_at=_standing_at(progress, report.outcome, observed.place),
        )
        if report.outcome is Outcome.BATTERY_EMPTY:
            return progress.finished(failure=f"battery empty during {action.text}")
        if report.outcome is not Outcome.SUCCESS:
            progress, count = progress.failed_once_more()
            if count >= _SAME_FAILURES:
                return progress.finished(failure=f"{action.text} failed {count} times: {_reason(report)}")
        if report.outcome is Outcome.BLOCKED:
            progress = progress.closing(care.ways_closed_by(action))
        return self.proceed(progress, situation)

    def proceed(self, progress: TaskProgress, situation: Situation) -> TaskProgress:
        """Plans from the observed state and dispatches the plan's first action, or finishes the task."""
        care = self._tasks[progress.task.name]
        if not all(map(math.isfinite, situation.pose)):
            return _wait(progress)
        state = care.observed_state(
            situation.observed,
            situation.pose,
            standing_at=progress.standing_at,
            closed=progress.closed,
            learned=situation.learned,
        )
        plan = self._solve(care, state, situation.weights)
        progress = progress.following(_message(plan, sequence=progress.plan.sequence + 1), state)
        where = f"{care.place(state) or 'in transit'} at charge {situation.observed.charge:.2f}"
        failure = self._failure(plan, len(progress.report.actions), where)
        if failure or not plan.actions:
            return progress.finished(failure=failure)
        text = plan.actions[0]
        expected = care.planning_task.apply(state, text)
        action = care.action(text, state, expected, sequence=progress.action.sequence + 1)
        return progress.dispatching(action, expected, care.features(state, text))

    def _failure(self, plan: Plan, actions_done: int, where: str) -> str:
        """Why a plan cannot be followed; empty if it can."""
        if plan.status == "timeout":
            return f"the planner gave up after {plan.expanded} expansions"
        if not plan.found:
            return f"no plan from {where}"
        if plan.actions and actions_done >= self._max_actions:
            return f"not done after {self._max_actions} actions"
        return ""

    def _solve(self, care: CareTask, state: PlannerState, weights: tuple[float, ...]) -> Plan:
        started = time.perf_counter()
        plan = self._planners[care.name].solve(state, weights, max_expansions=self._max_expansions)
        self.solve_seconds.append(time.perf_counter() - started)
        return plan


def _message(plan: Plan, *, sequence: int) -> PlanMessage:
    cost = 0.0 if plan.cost is None else float(plan.cost)
    return PlanMessage(sequence, _STATUS[plan.status], plan.actions, cost)


def _wait(progress: TaskProgress) -> TaskProgress:
    if progress.waits >= _MOST_WAITS:
        return progress.finished(failure="the robot's position is not known")
    return replace(progress, waits=progress.waits + 1)


def _standing_at(progress: TaskProgress, outcome: Outcome, observed_place: str) -> str:
    """Where the robot now stands ready to do something, by what the executors say."""
    action = progress.action
    if action.kind is ActionKind.MOVE:
        return action.place if outcome is Outcome.SUCCESS and observed_place == action.place else ""
    return "" if outcome is Outcome.OUT_OF_REACH else progress.standing_at


def _reason(report: ActionReport) -> str:
    return report.outcome.value + (f" ({report.detail})" if report.detail else "")
