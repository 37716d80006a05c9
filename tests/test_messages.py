"""The values on abstract ports: immutable, free to copy, and empty by default."""

from __future__ import annotations

import copy
from dataclasses import FrozenInstanceError, fields

import pytest
from pydrake.common.value import Value

from mala_drake import messages as mut

OWN = [
    kind
    for kind in vars(mut).values()
    if isinstance(kind, type) and issubclass(kind, mut.Message) and kind is not mut.Message
]


@pytest.mark.parametrize("kind", OWN)
def test_a_copy_is_the_value_itself(kind):
    message = kind()
    assert copy.deepcopy(message) is message
    assert copy.copy(message) is message
    assert Value(message).Clone().get_value() is message


@pytest.mark.parametrize("kind", OWN)
def test_it_cannot_be_changed(kind):
    message = kind()
    with pytest.raises(FrozenInstanceError):
        setattr(message, fields(kind)[0].name, None)
    assert not hasattr(message, "__dict__")


@pytest.mark.parametrize("kind", OWN)
def test_equal_contents_are_equal_messages(kind):
    assert kind() == kind()
    assert hash(kind()) == hash(kind())


@pytest.mark.parametrize("kind", [kind for kind in OWN if "sequence" in {item.name for item in fields(kind)}])
def test_the_default_means_nothing_yet(kind):
    assert kind().sequence == 0


def test_an_action_reads_as_in_pddl():
    assert mut.Action(1, mut.ActionKind.MOVE, "go_to", ("robot1", "home")).text == "(go_to robot1 home)"
    assert mut.Action(1, mut.ActionKind.IN_PLACE, "wait").text == "(wait)"


@pytest.mark.parametrize("outcome", mut.Outcome)
def test_a_report_is_finished_by_every_outcome_but_running(outcome):
    assert mut.ActionReport(3, outcome).finished == (outcome is not mut.Outcome.RUNNING)


def test_a_report_on_nothing_is_not_finished():
    assert not mut.ActionReport(0, mut.Outcome.SUCCESS).finished


def test_an_atom_that_is_not_grounded_has_membership_zero():
    memberships = mut.Memberships((("at", "robot1", "home"),), (0.7,))
    assert memberships.value(("at", "robot1", "home")) == 0.7
    assert memberships.value(("at", "robot1", "stove")) == 0.0


def test_preferences_begin_uniform():
    for weights in (mut.Preferences().planning, mut.Preferences().estimate):
        assert weights == (0.2,) * 5
