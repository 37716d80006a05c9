"""Forms of records: whatever JSON is there, it fits or is refused in one short line."""

from __future__ import annotations

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.experiments import record_form as mut

LEAVES = st.one_of(st.none(), st.booleans(), st.integers(), st.just(10**400), st.floats(), st.text())
VALUES = st.recursive(LEAVES, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=12)
FORMS = (
    mut.text,
    mut.action,
    mut.flag,
    mut.whole,
    mut.number,
    mut.positive,
    mut.measured,
    mut.name_with_unit,
    mut.or_null(mut.number),
    mut.list_of(mut.measured, 0, 2),
    mut.mapping_to(mut.list_of(mut.number)),
    mut.entry({"place": mut.text}, {"x": mut.number}),
)


def as_text(value):
    """NaN stands for null."""
    return json.dumps(value).replace("NaN", "null")


@given(VALUES)
def test_any_value_is_kept_as_it_is_or_refused_in_one_short_line(value):
    for form in FORMS:
        try:
            kept, refusal = form(value, "here"), None
        except BadInput as error:
            kept, refusal = value, error
        assert as_text(kept) == as_text(value)
        assert refusal is None or (refusal.where.startswith("here") and len(refusal.what) < 80 and refusal.expected)


@pytest.mark.parametrize("value", [True, "1", math.inf, math.nan, 10**400])
def test_what_is_no_finite_number_is_no_number(value):
    with pytest.raises(BadInput, match="a finite number"):
        mut.number(value, "here")


def test_what_is_wrong_inside_is_told_by_where_it_is():
    form = mut.list_of(mut.entry({"place": mut.text}, {"ends": mut.mapping_to(mut.list_of(mut.number, 2))}))
    with pytest.raises(BadInput, match=r"^legs\[1\]\.ends\.y\[0\]: null; expected a finite number$"):
        form([{"place": "a"}, {"place": "b", "ends": {"x": [1, 2], "y": [None, 2]}}], "legs")


def test_a_key_that_nobody_knows_is_kept():
    form = mut.entry({"place": mut.text})
    assert form({"place": "a", "new": [3]}, "leg") == {"place": "a", "new": [3]}
