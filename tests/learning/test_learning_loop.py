"""Scheduler, patient and learner together: tasks are issued, rated, and learned from."""

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder, LeafSystem

from mala_drake.clock import PLAN_OFFSET, TICK
from mala_drake.learning import PreferenceLearner, ProjectedGradient, convergence_episode, preference_distance
from mala_drake.messages import EpisodeReport, Preferences, Task, TaskReport
from mala_drake.patient import PROFILES, Patient
from mala_drake.randomness import keyed_generator
from mala_drake.scheduling import Scheduler, task_names

EPISODES = 12


class Executor(LeafSystem):
    """Does each task in a second, with features of its own, and notes the preferences it was started with."""

    def __init__(self):
        super().__init__()
        self.started_with = []
        self._task = self.DeclareAbstractInputPort("task", Value(Task()))
        self._preferences = self.DeclareAbstractInputPort("preferences", Value(Preferences()))
        self._state = self.DeclareAbstractState(Value((Task(), 0.0)))
        prerequisites = {self.abstract_state_ticket(self._state), self.time_ticket()}
        for name, message in (("task_report", TaskReport), ("episode_report", EpisodeReport)):
            self.DeclareAbstractOutputPort(
                name, lambda message=message: Value(message()), getattr(self, f"_calc_{name}"), prerequisites
            )
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICK, PLAN_OFFSET, self._update)

    def _update(self, context, state):
        task = self._task.Eval(context)
        if task.sequence > context.get_abstract_state(self._state).get_value()[0].sequence:
            self.started_with.append(self._preferences.Eval(context))
            state.get_mutable_abstract_state(self._state).set_value((task, context.get_time()))

    def _finished(self, context):
        task, started = context.get_abstract_state(self._state).get_value()
        return task if task.sequence > 0 and context.get_time() >= started + 1.0 - 1e-6 else None

    def _calc_task_report(self, context, output):
        task = self._finished(context)
        output.set_value(TaskReport(task.sequence, finished=True, success=True) if task else TaskReport())

    def _calc_episode_report(self, context, output):
        task = self._finished(context)
        if task is None:
            output.set_value(EpisodeReport())
            return
        features = keyed_generator(0, task.episode, "features").uniform(0.2, 0.9, 5)
        output.set_value(EpisodeReport(task.sequence, task.name, success=True, features=tuple(features.tolist())))


@pytest.fixture(scope="module")
def run():
    """The executor after a whole run, with the diagram's last preferences and progress."""
    builder = DiagramBuilder()
    scheduler = builder.AddSystem(Scheduler(tasks=task_names("alternate", episodes=EPISODES)))
    executor = builder.AddSystem(Executor())
    patient = builder.AddSystem(Patient(profile_weights=PROFILES["speed_oriented"], seed=1))
    learner = builder.AddSystem(PreferenceLearner(learner=ProjectedGradient(), seed=1))
    for output, inputs in (
        (scheduler.GetOutputPort("task"), executor.GetInputPort("task")),
        (executor.GetOutputPort("task_report"), scheduler.GetInputPort("task_report")),
        (executor.GetOutputPort("episode_report"), patient.GetInputPort("episode_report")),
        (patient.GetOutputPort("ratings"), learner.GetInputPort("ratings")),
        (learner.GetOutputPort("preferences"), executor.GetInputPort("preferences")),
    ):
        builder.Connect(output, inputs)
    simulator = Simulator(builder.Build())
    simulator.AdvanceTo(EPISODES * 1.5)
    context = simulator.get_context()
    preferences = learner.GetOutputPort("preferences").Eval(learner.GetMyContextFromRoot(context))
    progress = scheduler.GetOutputPort("progress").Eval(scheduler.GetMyContextFromRoot(context))
    return executor.started_with, preferences, progress


def test_every_task_is_done_and_rated_once(run):
    _, preferences, progress = run
    assert progress.closed
    assert [report.sequence for report in progress.reports] == list(range(1, EPISODES + 1))
    assert preferences.updates == EPISODES


def test_each_task_starts_with_what_was_learned_from_all_before_it(run):
    started_with, _, _ = run
    assert [preferences.updates for preferences in started_with] == list(range(EPISODES))


def test_the_patients_weights_are_approached(run):
    started_with, final, _ = run
    estimates = [preferences.estimate for preferences in [*started_with[1:], final]]
    distances = [preference_distance(estimate, PROFILES["speed_oriented"]) for estimate in estimates]
    assert convergence_episode(distances) <= 5
    assert distances[-1] <= 0.15


def test_what_is_planned_with_scatters_round_the_estimate_less_and_less(run):
    started_with, _, _ = run
    scatter = [np.linalg.norm(np.subtract(p.planning, p.estimate)) for p in started_with]
    assert all(scatter)
    assert np.mean(scatter[EPISODES // 2 :]) < np.mean(scatter[: EPISODES // 2])
