import copy
import pickle
from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.planning.state as mut
from mala_drake.errors import BadInput

STATE = mut.SymbolicState(frozenset({("at", "robot1", "home")}), {("charge", "robot1"): Fraction(1)})


def test_changes_make_new_states_and_leave_the_old_one():
    moved = STATE.with_facts(add=[("at", "robot1", "bed")], remove=["(AT robot1 home)"])
    assert moved.holds("(at robot1 bed)")
    assert not moved.holds(("at", "robot1", "home"))
    assert STATE.holds("(at robot1 home)")


def test_removing_and_adding_the_same_fact_keeps_it():
    assert STATE.with_facts(add=["(at robot1 home)"], remove=["(at robot1 home)"]) == STATE


def test_values_are_exact_and_floats_rounded_to_the_grid():
    name = ("charge", "robot1")
    assert STATE.with_fluents({name: 0.63}).value(name) == Fraction(63, 100)
    assert STATE.with_fluents({name: 1 / 3}).value(name) == Fraction(333333, 1000000)
    assert STATE.with_fluents({name: Fraction(1, 3)}).value(name) == Fraction(1, 3)
    assert STATE.with_fluents({name: Decimal("0.1234567")}).value(name) == Fraction(1234567, 10**7)
    assert STATE.value("(unknown)") is None


@pytest.mark.parametrize("value", [1e303, -1.7e308])
def test_the_largest_floats_are_whole_numbers_already(value):
    assert mut.as_exact(value, where="x") == Fraction(value)


@given(st.floats(-1e6, 1e6))
def test_rounding_moves_a_float_by_half_a_step_at_most(value):
    # The float itself may be off the true product by an ulp, hence the slack.
    assert abs(mut.as_exact(value, where="x") - Fraction(value)) <= Fraction(1, 2 * 10**mut.DECIMALS) + Fraction(
        1, 10**9
    )


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "1", True, Decimal("nan")])
def test_what_is_not_a_finite_number_is_refused(value):
    with pytest.raises(BadInput, match="finite number"):
        STATE.with_fluents({"(charge robot1)": value})


def test_states_are_values_that_travel():
    assert copy.deepcopy(STATE) is STATE
    assert pickle.loads(pickle.dumps(STATE)) == STATE
    assert len({STATE, STATE.with_facts()}) == 1
    with pytest.raises(TypeError):
        STATE.values["charge", "robot1"] = Fraction(0)
