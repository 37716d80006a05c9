"""The task planner as a system: a new plan after every executed action, from the observed symbolic state."""

from __future__ import annotations

from collections.abc import Collection

from pydrake.common.value import Value
from pydrake.systems.framework import Context, LeafSystem, State

from mala_drake.clock import PLAN_OFFSET, TICK
from mala_drake.errors import BadInput
from mala_drake.messages import (
    Action,
    ActionKind,
    ActionReport,
    Atom,
    LearnedCosts,
    PlanMessage,
    Preferences,
    SymbolicState,
    Task,
    TaskReport,
)
from mala_drake.optional_input import told
from mala_drake.planning.care_tasks import TASK_NAMES, CareTask
from mala_drake.planning.leg_costs import LegCosts
from mala_drake.planning.task_executive import Situation, TaskExecutive
from mala_drake.planning.task_progress import TaskProgress
from mala_drake.ward.ward_map import Ward


class TaskPlanner(LeafSystem):
    """Turns tasks into actions, one at a time, by optimal planning in closed loop.

    .. pydrake_system::

        name: TaskPlanner
        input_ports:
        - task
        - symbolic_state
        - robot_state
        - leg_report
        - in_place_report
        - preferences
        - learned_costs
        output_ports:
        - action
        - plan
        - task_report

    On a new task, and after every finished action, it plans from the *observed* symbolic state, the charge and the
    current planning weights, and dispatches the first action of the optimal plan. Actions cost what `learned_costs`
    says, and what is predicted from the map where it says nothing or is not connected. `robot_state` is (x, y, yaw,
    v_x, v_y, omega_z); its pose tells where legs begin that do not start at a named place.

    A task ends with success once its goal is observed. It ends with a failure, and the reason in the report, when no
    plan leads to the goal, when a search reaches its limit, after too many actions, when the same action fails three
    times, or when the battery is empty. A leg that finds its way blocked closes that way for the rest of the task.

    The clock makes every observation newer than the report it is read with: executors report after the planner's
    moment in a tick, and the world establishes an action's effects before the planner's moment in the next one.

    Attributes:
        solve_seconds: wall time of each search so far. Only the record of a run reads it, nothing in the diagram
            does: wall time is different in every run, so it must not be part of the state.
    """

    def __init__(
        self,
        ward: Ward,
        *,
        tasks: Collection[str] = TASK_NAMES,
        max_actions: int = 60,
        max_expansions: int = 200_000,
        costs: LegCosts | None = None,
    ) -> None:
        """Constructs the planner; reads the domains.

        Args:
            ward: the map.
            tasks: the names of those it is to know.
            max_actions: of one task, after which it has failed.
            max_expansions: of one search.
            costs: predictions of legs; None for those of this ward and robot.

        Raises:
            BadInput: if a limit is not positive, there is no such task, or a domain does not fit the ward.
        """
        super().__init__()
        for name, limit in (("max_actions", max_actions), ("max_expansions", max_expansions)):
            if limit < 1:
                raise BadInput(name, str(limit), "an integer >= 1")
        known = {name: CareTask(name, ward, costs=costs) for name in tasks}
        self._executive = TaskExecutive(known, max_actions=max_actions, max_expansions=max_expansions)
        self.solve_seconds = self._executive.solve_seconds
        self._task = self.DeclareAbstractInputPort("task", Value(Task()))
        self._symbolic_state = self.DeclareAbstractInputPort("symbolic_state", Value(SymbolicState()))
        self._robot_state = self.DeclareVectorInputPort("robot_state", 6)
        self._leg_report = self.DeclareAbstractInputPort("leg_report", Value(ActionReport()))
        self._in_place_report = self.DeclareAbstractInputPort("in_place_report", Value(ActionReport()))
        self._preferences = self.DeclareAbstractInputPort("preferences", Value(Preferences()))
        self._learned_costs = self.DeclareAbstractInputPort("learned_costs", Value(LearnedCosts()))
        self._progress = self.DeclareAbstractState(Value(TaskProgress()))
        ticket = {self.abstract_state_ticket(self._progress)}
        self.DeclareAbstractOutputPort(
            "action", lambda: Value(Action()), self._calc_action, prerequisites_of_calc=ticket
        )
        self.DeclareAbstractOutputPort(
            "plan", lambda: Value(PlanMessage()), self._calc_plan, prerequisites_of_calc=ticket
        )
        self.DeclareAbstractOutputPort(
            "task_report", lambda: Value(TaskReport()), self._calc_task_report, prerequisites_of_calc=ticket
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, PLAN_OFFSET, self._update)

    @property
    def predictions(self) -> dict[Atom, float]:
        """What can be learned about the costs of all its tasks: ground fluents, as predicted from the map."""
        return self._executive.predictions

    def progress(self, context: Context) -> TaskProgress:
        """The task being worked on: its symbolic state, plan and report."""
        progress: TaskProgress = context.get_abstract_state(self._progress).get_value()
        return progress

    def _calc_action(self, context: Context, output: Value) -> None:
        output.set_value(self.progress(context).action)

    def _calc_plan(self, context: Context, output: Value) -> None:
        output.set_value(self.progress(context).plan)

    def _calc_task_report(self, context: Context, output: Value) -> None:
        output.set_value(self.progress(context).report)

    def _update(self, context: Context, state: State) -> None:
        before = self.progress(context)
        after = self._advanced(context, before)
        if after is not before:
            state.get_mutable_abstract_state(self._progress).set_value(after)

    def _advanced(self, context: Context, progress: TaskProgress) -> TaskProgress:
        task: Task = self._task.Eval(context)
        if task.sequence > progress.task.sequence:
            return self._executive.begin(progress, task, self._situation(context))
        if not progress.working:
            return progress
        if not progress.acting:
            return self._executive.proceed(progress, self._situation(context))
        moving = progress.action.kind is ActionKind.MOVE
        report: ActionReport = (self._leg_report if moving else self._in_place_report).Eval(context)
        if report.sequence == progress.action.sequence and report.finished:
            return self._executive.conclude(progress, report, self._situation(context))
        return progress

    def _situation(self, context: Context) -> Situation:
        x, y, yaw = self._robot_state.Eval(context)[:3].tolist()
        preferences: Preferences = self._preferences.Eval(context)
        learned = told(self._learned_costs, context, LearnedCosts())
        return Situation(self._symbolic_state.Eval(context), (x, y, yaw), preferences.planning, learned)
