"""Tasks one after another: which names a run has, and when the next one is issued."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mala_drake.errors import BadInput
from mala_drake.messages import Message, Task, TaskReport

ALTERNATING_TASKS = ("medication", "meal")


def task_names(choice: str, *, episodes: int) -> tuple[str, ...]:
    """The task of each episode of a run.

    Args:
        choice: the name of the one task to repeat, or "alternate" for medication and meal in turn.
        episodes: how many, >= 0.

    Raises:
        BadInput: if `episodes` is negative or the choice is empty.
    """
    if episodes < 0:
        raise BadInput("episodes", str(episodes), "an integer >= 0")
    if not choice:
        raise BadInput("task", "an empty name", "the name of a task or 'alternate'")
    turns = ALTERNATING_TASKS if choice == "alternate" else (choice,)
    return tuple(turns[episode % len(turns)] for episode in range(episodes))


@dataclass(frozen=True, slots=True)
class Progress(Message):
    """How far a run has come.

    Attributes:
        task: the one issued last; `Task()` before the first.
        issued: how many tasks of the run have been issued, those before a resumption included.
        reports: of the tasks closed since the start or resumption, in order.
        closed: whether the last task of the run has been closed.
    """

    task: Task = Task()
    issued: int = 0
    reports: tuple[TaskReport, ...] = ()
    closed: bool = False


def advance(progress: Progress, report: TaskReport, names: Sequence[str]) -> Progress:
    """The progress after looking at the latest task report once.

    The current task is closed by a finished report with its own sequence number, whether it succeeded or not; the
    next one is then issued in the same step. Any other report changes nothing. A run without tasks is closed at once.

    Args:
        progress: so far.
        report: the planner's latest.
        names: of all tasks of the run.
    """
    if progress.closed:
        return progress
    reports = progress.reports
    if progress.task.sequence > 0:
        if not (report.finished and report.sequence == progress.task.sequence):
            return progress
        reports = (*reports, report)
    issued = progress.issued
    if issued == len(names):
        return Progress(progress.task, issued, reports, closed=True)
    return Progress(Task(issued + 1, names[issued], issued), issued + 1, reports)
