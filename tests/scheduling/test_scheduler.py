import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder, LeafSystem

import mala_drake.scheduling as mut
from mala_drake.clock import TICK
from mala_drake.errors import BadInput
from mala_drake.messages import Task, TaskReport


@pytest.fixture
def dut():
    return mut.Scheduler(tasks=["medication", "meal"])


class Worker(LeafSystem):
    """Finishes every task a second after it was first seen."""

    def __init__(self):
        super().__init__()
        self._task = self.DeclareAbstractInputPort("task", Value(Task()))
        state = self.DeclareAbstractState(Value((0, 0.0)))
        self._state = state
        self.DeclareAbstractOutputPort(
            "report",
            lambda: Value(TaskReport()),
            self._calc_report,
            prerequisites_of_calc={self.abstract_state_ticket(state), self.time_ticket()},
        )
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, 0.003, self._update)

    def _update(self, context, state):
        task = self._task.Eval(context)
        if task.sequence > context.get_abstract_state(self._state).get_value()[0]:
            state.get_mutable_abstract_state(self._state).set_value((task.sequence, context.get_time()))

    def _calc_report(self, context, output):
        sequence, started = context.get_abstract_state(self._state).get_value()
        finished = sequence > 0 and context.get_time() >= started + 1.0
        output.set_value(TaskReport(sequence, finished=finished, success=finished))


def test_drawn_ports_are_the_real_ports(dut, assert_port_box):
    assert_port_box(dut)


def test_the_first_task_is_issued_at_the_first_tick_and_stays(dut):
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    dut.GetInputPort("task_report").FixValue(context, Value(TaskReport()))
    assert dut.GetOutputPort("task").Eval(context) == Task()
    simulator.AdvanceTo(TICK / 2)
    assert dut.GetOutputPort("task").Eval(context) == Task(1, "medication", 0)
    simulator.AdvanceTo(5.0)
    assert dut.GetOutputPort("task").Eval(context) == Task(1, "medication", 0)
    assert dut.GetOutputPort("closed").Eval(context) == [0.0]


def test_tasks_follow_one_another_until_the_run_is_closed(dut):
    builder = DiagramBuilder()
    builder.AddSystem(dut)
    worker = builder.AddSystem(Worker())
    builder.Connect(dut.GetOutputPort("task"), worker.GetInputPort("task"))
    builder.Connect(worker.GetOutputPort("report"), dut.GetInputPort("task_report"))
    simulator = Simulator(builder.Build())
    context = dut.GetMyContextFromRoot(simulator.get_context())

    simulator.AdvanceTo(0.9)
    assert dut.GetOutputPort("task").Eval(context).sequence == 1
    simulator.AdvanceTo(1.5)
    assert dut.GetOutputPort("task").Eval(context) == Task(2, "meal", 1)
    simulator.AdvanceTo(4.0)
    progress = dut.GetOutputPort("progress").Eval(context)
    assert dut.GetOutputPort("closed").Eval(context) == [1.0]
    assert progress.closed
    assert [(report.sequence, report.success) for report in progress.reports] == [(1, True), (2, True)]


def test_a_fresh_context_can_start_at_any_episode(dut):
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    dut.GetInputPort("task_report").FixValue(context, Value(TaskReport()))
    dut.start_at(context, episode=1)
    assert dut.GetOutputPort("task").Eval(context) == Task()  # Nothing is issued before the tick.
    simulator.AdvanceTo(TICK / 2)
    assert dut.GetOutputPort("task").Eval(context) == Task(2, "meal", 1)


def test_starting_after_the_last_episode_closes_the_run_at_the_first_tick(dut):
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    dut.GetInputPort("task_report").FixValue(context, Value(TaskReport()))
    dut.start_at(context, episode=2)
    simulator.AdvanceTo(TICK / 2)
    assert dut.GetOutputPort("closed").Eval(context) == [1.0]


@pytest.mark.parametrize("episode", [-1, 3])
def test_an_episode_that_the_run_does_not_have_is_refused(dut, episode):
    with pytest.raises(BadInput, match=f"^episode: {episode}; expected a number from 0 to 2"):
        dut.start_at(dut.CreateDefaultContext(), episode=episode)


def test_a_run_without_tasks_is_closed_at_the_first_tick():
    dut = mut.Scheduler(tasks=[])
    simulator = Simulator(dut)
    context = simulator.get_mutable_context()
    dut.GetInputPort("task_report").FixValue(context, Value(TaskReport()))
    simulator.AdvanceTo(TICK / 2)
    assert dut.GetOutputPort("closed").Eval(context) == [1.0]
    assert dut.GetOutputPort("task").Eval(context) == Task()


def test_a_task_without_a_name_is_refused():
    with pytest.raises(BadInput, match=r"^tasks\[1\]"):
        mut.Scheduler(tasks=["a", ""])
