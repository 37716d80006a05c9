"""The laws of t-norms and t-conorms, for every family."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mala_drake.grounding import LukasiewiczNorms, MinimumNorms, ProductNorms, negation

degrees = st.floats(0.0, 1.0)
families = st.sampled_from([MinimumNorms(), ProductNorms(), LukasiewiczNorms()])
ROUNDING = 1e-12
STEP = 1e-6

# The paper's own formulas, Sec. "Fuzzy Logic".
PAPER = {
    MinimumNorms(): (min, max),
    ProductNorms(): (lambda a, b: a * b, lambda a, b: a + b - a * b),
    LukasiewiczNorms(): (lambda a, b: max(0.0, a + b - 1.0), lambda a, b: min(1.0, a + b)),
}


@given(families, degrees, degrees)
def test_both_norms_are_the_papers_formulas(norms, a, b):
    conjunction, disjunction = PAPER[norms]
    assert norms.conjunction([a, b]) == pytest.approx(conjunction(a, b), abs=ROUNDING)
    assert norms.disjunction([a, b]) == pytest.approx(disjunction(a, b), abs=ROUNDING)


@given(families, st.lists(degrees, max_size=6))
def test_results_are_degrees_of_truth(norms, values):
    for result in (norms.conjunction(values), norms.disjunction(values)):
        assert -ROUNDING <= result <= 1.0 + ROUNDING


@given(families, degrees, degrees)
def test_they_are_commutative(norms, a, b):
    assert norms.conjunction([a, b]) == pytest.approx(norms.conjunction([b, a]), abs=ROUNDING)
    assert norms.disjunction([a, b]) == pytest.approx(norms.disjunction([b, a]), abs=ROUNDING)


@given(families, degrees, degrees, degrees)
def test_they_are_associative_and_so_one_call_joins_any_number(norms, a, b, c):
    for operation in (norms.conjunction, norms.disjunction):
        left = operation([operation([a, b]), c])
        right = operation([a, operation([b, c])])
        assert left == pytest.approx(right, abs=ROUNDING)
        assert operation([a, b, c]) == pytest.approx(left, abs=ROUNDING)


@given(families, degrees, degrees, degrees)
def test_they_are_monotone(norms, a, b, c):
    low, high = sorted((b, c))
    assert norms.conjunction([a, low]) <= norms.conjunction([a, high]) + ROUNDING
    assert norms.disjunction([a, low]) <= norms.disjunction([a, high]) + ROUNDING


@given(families, degrees)
def test_one_is_neutral_for_and_zero_for_or(norms, a):
    assert norms.conjunction([a, 1.0]) == pytest.approx(a, abs=ROUNDING)
    assert norms.disjunction([a, 0.0]) == pytest.approx(a, abs=ROUNDING)


@given(families, st.lists(degrees, max_size=5))
def test_de_morgan(norms, values):
    values = np.array(values)
    assert norms.disjunction(values) == pytest.approx(
        float(negation(norms.conjunction(negation(values)))), abs=ROUNDING
    )


@given(families, degrees, degrees)
def test_minimum_and_maximum_bound_every_family(norms, a, b):
    assert norms.conjunction([a, b]) <= min(a, b) + ROUNDING
    assert norms.disjunction([a, b]) >= max(a, b) - ROUNDING


@given(families)
def test_the_norms_of_nothing_are_their_neutral_elements(norms):
    assert norms.conjunction([]) == 1.0
    assert norms.disjunction([]) == 0.0
    assert norms.conjunction_gradient([]).shape == (0,)
    assert norms.disjunction_gradient([]).shape == (0,)


@given(families, st.lists(st.floats(0.01, 0.99), min_size=1, max_size=5))
def test_gradients_are_those_of_finite_differences_away_from_kinks(norms, values):
    values = np.array(values)
    gaps = np.diff(np.sort(values))
    assume(gaps.size == 0 or gaps.min() > 1e-4)
    assume(abs(np.sum(values) - 1.0) > 1e-4 and abs(np.sum(1.0 - values) - 1.0) > 1e-4)
    steps = STEP * np.eye(values.size)
    for operation, gradient in (
        (norms.conjunction, norms.conjunction_gradient),
        (norms.disjunction, norms.disjunction_gradient),
    ):
        differences = (operation(values + steps) - operation(values - steps)) / (2.0 * STEP)
        np.testing.assert_allclose(gradient(values), differences, atol=1e-8)


@given(families, st.lists(st.lists(degrees, min_size=3, max_size=3), min_size=1, max_size=4))
def test_rows_are_joined_each_for_itself(norms, rows):
    np.testing.assert_array_equal(norms.conjunction(rows), [norms.conjunction(row) for row in rows])
    np.testing.assert_array_equal(norms.conjunction_gradient(rows), [norms.conjunction_gradient(row) for row in rows])
    np.testing.assert_array_equal(norms.disjunction(rows), [norms.disjunction(row) for row in rows])
