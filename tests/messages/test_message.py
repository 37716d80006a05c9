"""The values on abstract ports: immutable, free to copy, and empty by default."""

from __future__ import annotations

import copy
from dataclasses import FrozenInstanceError, fields

import pytest
from pydrake.common.value import Value

from mala_drake import messages
from mala_drake.messages import message as mut

OWN = [
    kind
    for kind in vars(messages).values()
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
