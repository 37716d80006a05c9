import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.messages import Task, TaskReport
from mala_drake.scheduling import Progress, advance, task_names

NAMES = ("medication", "meal", "medication")


def test_one_task_is_repeated():
    assert task_names("medication", episodes=3) == ("medication",) * 3


def test_alternate_takes_medication_and_meal_in_turn():
    assert task_names("alternate", episodes=3) == ("medication", "meal", "medication")


@pytest.mark.parametrize(
    ("choice", "options", "where"),
    [
        ("", {"episodes": 1}, "task"),
        ("meal", {"episodes": -1}, "episodes"),
    ],
)
def test_bad_choices_are_refused(choice, options, where):
    with pytest.raises(BadInput) as error:
        task_names(choice, **options)
    assert error.value.where == where


def test_the_first_task_is_issued_without_a_report():
    assert advance(Progress(), TaskReport(), NAMES).task == Task(1, "medication", 0)


def test_a_task_goes_on_until_its_own_report_is_finished():
    progress = advance(Progress(), TaskReport(), NAMES)
    for report in (TaskReport(), TaskReport(1, finished=False), TaskReport(2, finished=True)):
        assert advance(progress, report, NAMES) == progress


@pytest.mark.parametrize("success", [True, False])
def test_a_finished_task_is_closed_and_the_next_one_issued(success):
    report = TaskReport(1, finished=True, success=success)
    progress = advance(advance(Progress(), TaskReport(), NAMES), report, NAMES)
    assert progress == Progress(Task(2, "meal", 1), 2, (report,))


@given(st.integers(0, 6))
def test_a_run_closes_every_task_once_in_order(count):
    names = task_names("alternate", episodes=count)
    progress, report = Progress(), TaskReport()
    for _ in range(3 * count + 3):  # Each report is seen several times, as a planner repeats it every tick.
        progress = advance(progress, report, names)
        if not progress.closed:
            assert progress.task.episode == progress.task.sequence - 1
            report = TaskReport(progress.task.sequence, finished=True, success=True)
    assert progress.closed
    assert [report.sequence for report in progress.reports] == list(range(1, count + 1))


def test_a_resumed_run_issues_the_next_task_under_its_own_number():
    resumed = advance(Progress(issued=2), TaskReport(), NAMES)
    assert resumed == Progress(Task(3, "medication", 2), 3)


def test_a_run_without_tasks_is_closed_at_once():
    assert advance(Progress(), TaskReport(), ()) == Progress(closed=True)
