"""What actions and reports tell about themselves."""

from __future__ import annotations

import pytest

from mala_drake.messages import actions as mut


def test_an_action_reads_as_in_pddl():
    assert mut.Action(1, mut.ActionKind.MOVE, "go_to", ("robot1", "home")).text == "(go_to robot1 home)"
    assert mut.Action(1, mut.ActionKind.IN_PLACE, "wait").text == "(wait)"


@pytest.mark.parametrize("outcome", mut.Outcome)
def test_a_report_is_finished_by_every_outcome_but_running(outcome):
    assert mut.ActionReport(3, outcome).finished == (outcome is not mut.Outcome.RUNNING)


def test_a_report_on_nothing_is_not_finished():
    assert not mut.ActionReport(0, mut.Outcome.SUCCESS).finished
