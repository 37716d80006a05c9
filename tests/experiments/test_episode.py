"""What is carried from episode to episode goes through JSON bit for bit."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.experiments import episode as mut

NUMBERS = st.lists(st.floats(allow_nan=False, allow_infinity=False), max_size=8).map(tuple)


@given(st.integers(0, 10**9), st.none() | st.dictionaries(st.text(), NUMBERS, max_size=3))
def test_json_gives_back_every_bit(ticks, learners):
    carried = mut.Carried(ticks, learners)
    again = mut.Carried.from_json(json.loads(json.dumps(carried.to_json(), allow_nan=False)), where="file")
    assert again == carried
    # Equality does not tell the zeros apart.
    assert [[number.hex() for number in state] for state in (again.learners or {}).values()] == [
        [number.hex() for number in state] for state in (learners or {}).values()
    ]


@pytest.mark.parametrize(
    "data", [None, [], {}, {"ticks": 1}, {"ticks": "soon", "learners": None}, {"ticks": 1, "learners": {"a": ["b"]}}]
)
def test_anything_else_is_told_in_one_line(data):
    with pytest.raises(BadInput, match="file: "):
        mut.Carried.from_json(data, where="file")


def test_a_tick_is_a_fifth_of_a_second():
    assert mut.Carried(15).seconds == pytest.approx(3.0)
