from types import SimpleNamespace

import pytest

import mala_drake.robot.action_marks as mut


def sums(duration):
    return SimpleNamespace(duration=duration, risk=0.1 * duration, charge_used=0.01 * duration, discomfort=0.0)


@pytest.fixture
def marks():
    return mut.ActionMarks.Zero()


def test_nothing_has_ended_before_the_first_action_is_over(marks):
    mut.mark_action(marks, sums(0.0), current=1, working=True)
    mut.mark_action(marks, sums(4.0), current=1, working=True)
    assert (marks.current, marks.finished) == (1, 0)


def test_an_action_ends_where_the_next_one_begins(marks):
    for duration, current in ((0.0, 1), (1.0, 1), (4.0, 2), (5.0, 2)):
        mut.mark_action(marks, sums(duration), current=current, working=True)
    assert (marks.finished, marks.duration, marks.risk, marks.charge_used) == pytest.approx((1, 4.0, 0.4, 0.04))
    mut.mark_action(marks, sums(10.0), current=3, working=True)
    assert (marks.finished, marks.duration) == pytest.approx((2, 6.0))


def test_the_last_action_ends_with_the_task_and_nothing_begins_after_it(marks):
    mut.mark_action(marks, sums(0.0), current=7, working=True)
    mut.mark_action(marks, sums(3.0), current=7, working=False)
    assert (marks.current, marks.finished, marks.duration) == (0, 7, 3.0)
    mut.mark_action(marks, sums(9.0), current=7, working=False)
    assert (marks.finished, marks.duration) == (7, 3.0)
