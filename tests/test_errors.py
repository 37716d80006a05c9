"""A user's mistake is one line, whatever it is made of."""

from __future__ import annotations

import pickle

from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput


def test_it_says_where_what_and_what_was_expected():
    error = BadInput("ward.yaml: places[3].yaw", "'north'", "a number")
    assert str(error) == "ward.yaml: places[3].yaw: 'north'; expected a number"
    assert (error.where, error.what, error.expected) == ("ward.yaml: places[3].yaw", "'north'", "a number")


def test_what_was_expected_may_be_left_out():
    assert str(BadInput("a.yaml", "is empty")) == "a.yaml: is empty"


@given(st.text(), st.text(), st.text())
def test_it_is_one_line_for_any_text(where, what, expected):
    assert len(str(BadInput(where, what, expected)).splitlines()) <= 1


@given(st.text(), st.text(), st.text())
def test_it_survives_the_way_from_another_process(where, what, expected):
    error = BadInput(where, what, expected)
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.where, copy.what, copy.expected) == (str(error), where, what, expected)
