"""The scheduler's first form: the tasks of the run, one after another."""

from __future__ import annotations

from collections.abc import Sequence

from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector, Context, LeafSystem, State

from mala_drake.clock import SCHEDULE_OFFSET, TICK
from mala_drake.errors import BadInput
from mala_drake.messages import Task, TaskReport
from mala_drake.scheduling.sequence import Progress, advance


class Scheduler(LeafSystem):
    """Issues one task at a time and closes each with its report.

    .. pydrake_system::

        name: Scheduler
        input_ports:
        - task_report
        output_ports:
        - task
        - progress
        - closed

    The first task is issued at the first tick, each next one a tick after the report of the one before it was
    finished: the episode is measured, rated and learned from within that tick. `progress` is the `Progress` message
    with the reports so far; `closed` is 1 once the last task is reported, 0 before.
    """

    def __init__(self, *, tasks: Sequence[str]) -> None:
        """Constructs the scheduler.

        Args:
            tasks: their names, in order (see `task_names`).

        Raises:
            BadInput: if a name is empty.
        """
        super().__init__()
        for index, name in enumerate(tasks):
            if not name:
                raise BadInput(f"tasks[{index}]", "an empty name", "the name of a task")
        self._tasks = tuple(tasks)
        self._report = self.DeclareAbstractInputPort("task_report", Value(TaskReport()))
        self._progress = self.DeclareAbstractState(Value(Progress()))
        ticket = {self.abstract_state_ticket(self._progress)}
        self.DeclareAbstractOutputPort("task", lambda: Value(Task()), self._calc_task, prerequisites_of_calc=ticket)
        self.DeclareAbstractOutputPort(
            "progress", lambda: Value(Progress()), self._calc_progress, prerequisites_of_calc=ticket
        )
        self.DeclareVectorOutputPort("closed", 1, self._calc_closed, prerequisites_of_calc=ticket)
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, SCHEDULE_OFFSET, self._update)

    def start_at(self, context: Context, *, episode: int) -> None:
        """Makes the task of `episode` the next one to be issued in `context`, as if those before were done.

        So each episode of a run can have a fresh context, and a resumed run goes on where it stopped: the task keeps
        the sequence number it has in the whole run.

        Raises:
            BadInput: unless the run has that episode (or ends just before it: then it is closed at the next tick).
        """
        if not 0 <= episode <= len(self._tasks):
            raise BadInput("episode", str(episode), f"a number from 0 to {len(self._tasks)}")
        context.SetAbstractState(self._progress, Progress(issued=episode))

    def _current(self, context: Context) -> Progress:
        progress: Progress = context.get_abstract_state(self._progress).get_value()
        return progress

    def _calc_task(self, context: Context, output: Value) -> None:
        output.set_value(self._current(context).task)

    def _calc_progress(self, context: Context, output: Value) -> None:
        output.set_value(self._current(context))

    def _calc_closed(self, context: Context, output: BasicVector) -> None:
        output[0] = float(self._current(context).closed)

    def _update(self, context: Context, state: State) -> None:
        progress = self._current(context)
        following = advance(progress, self._report.Eval(context), self._tasks)
        state.get_mutable_abstract_state(self._progress).set_value(following)
