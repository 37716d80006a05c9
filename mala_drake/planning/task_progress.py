"""How far a task has come: the one immutable value in the task planner's state."""

from __future__ import annotations

from dataclasses import dataclass, replace

from mala_drake.messages import Action, Atom, Message, Outcome, PlanMessage, Task, TaskReport
from mala_drake.planning.state import SymbolicState


@dataclass(frozen=True, slots=True)
class TaskProgress(Message):
    """A task, the plan being followed, and what became of the plan's actions so far.

    Attributes:
        task: the newest one; sequence 0 before the first.
        action: the newest one dispatched in the whole run.
        plan: the newest one.
        state: the planner's state that the plan starts from, None before the first.
        expected: the state that the plan expects after `action`.
        features: predicted for `action`.
        standing_at: the place whose standing pose the robot has last stopped at; empty for none.
        closed: the ways found blocked in this task.
        failures: how often each action has failed in this task.
        waits: ticks in a row without a usable position of the robot.
        report: on the task.
    """

    task: Task = Task()
    action: Action = Action()
    plan: PlanMessage = PlanMessage()
    state: SymbolicState | None = None
    expected: SymbolicState | None = None
    features: tuple[float, ...] = (0.0,) * 5
    standing_at: str = ""
    closed: tuple[tuple[str, str], ...] = ()
    failures: tuple[tuple[str, int], ...] = ()
    waits: int = 0
    report: TaskReport = TaskReport()

    @property
    def working(self) -> bool:
        """Whether there is a task that is not finished."""
        return self.task.sequence > 0 and not self.report.finished

    @property
    def acting(self) -> bool:
        """Whether an action has been dispatched and its report is awaited."""
        return self.working and self.expected is not None

    def begun(self, task: Task, *, at: str) -> TaskProgress:
        """A new task, for a robot that stands at a place; sequences of actions and plans go on counting."""
        return TaskProgress(
            task=task,
            action=self.action,
            plan=PlanMessage(sequence=self.plan.sequence),
            standing_at=at,
            report=TaskReport(sequence=task.sequence),
        )

    def executed(self, outcome: Outcome, *, differing: tuple[Atom, ...], standing_at: str) -> TaskProgress:
        """The current action has ended, well or badly; `differing` atoms are not as expected."""
        report = replace(
            self.report,
            actions=(*self.report.actions, self.action.text),
            predicted_features=tuple(a + b for a, b in zip(self.report.predicted_features, self.features, strict=True)),
            mismatches=self.report.mismatches + bool(differing),
            last_action=self.action,
            last_outcome=outcome,
            last_predicted=self.features,
            last_differing=differing,
        )
        return replace(self, report=report, expected=None, standing_at=standing_at)

    def failed_once_more(self) -> tuple[TaskProgress, int]:
        """The current action has failed; also how often it has by now."""
        counts = dict(self.failures)
        counts[self.action.text] = counts.get(self.action.text, 0) + 1
        return replace(self, failures=tuple(sorted(counts.items()))), counts[self.action.text]

    def closing(self, ways: tuple[tuple[str, str], ...]) -> TaskProgress:
        """With more ways closed."""
        return replace(self, closed=tuple(sorted({*self.closed, *ways})))

    def following(self, plan: PlanMessage, state: SymbolicState) -> TaskProgress:
        """With a new plan from an observed state; the first one's cost goes into the report."""
        if self.plan.status == "none":
            report = replace(self.report, plan_cost=plan.cost)
        else:
            report = replace(self.report, replans=self.report.replans + 1)
        return replace(self, plan=plan, state=state, waits=0, report=report)

    def dispatching(self, action: Action, expected: SymbolicState, features: tuple[float, ...]) -> TaskProgress:
        """With the plan's first action on its way."""
        return replace(self, action=action, expected=expected, features=features)

    def finished(self, *, failure: str = "") -> TaskProgress:
        """The task is over: done, or failed for a reason."""
        report = replace(self.report, finished=True, success=not failure, failure=failure)
        return replace(self, report=report, expected=None)
