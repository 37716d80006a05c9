import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mala_drake.grounding import (
    Complement,
    Gaussian,
    Intersection,
    LukasiewiczNorms,
    MinimumNorms,
    ProductNorms,
    Sigmoid,
    Trapezoidal,
    Union,
)

LOW = Sigmoid(0.3, -12.0)
MIDDLE = Gaussian(0.5, 0.2)
SETS = (LOW, MIDDLE, Sigmoid(0.8, 9.0))
families = st.sampled_from([MinimumNorms(), ProductNorms(), LukasiewiczNorms()])
arguments = st.floats(0.0, 1.0)
STEP = 1e-6


@given(arguments)
def test_the_default_operations_are_maximum_minimum_and_one_minus(x):
    values = [member.value(x) for member in SETS]
    assert Union(SETS).value(x) == max(values)
    assert Intersection(SETS).value(x) == min(values)
    assert Complement(LOW).value(x) == 1.0 - LOW.value(x)


@given(families, arguments)
def test_de_morgan_for_sets(norms, x):
    outside_each = Intersection(tuple(Complement(member) for member in SETS), norms)
    assert Complement(Union(SETS, norms)).value(x) == pytest.approx(float(outside_each.value(x)), abs=1e-12)


@given(families, arguments, st.sampled_from([Union, Intersection]))
def test_derivatives_are_those_of_finite_differences(norms, x, operation):
    made = operation(SETS, norms)
    slopes = [(made.value(x + sign * STEP) - made.value(x)) / (sign * STEP) for sign in (-1.0, 1.0)]
    assume(abs(slopes[0] - slopes[1]) < 1e-3)  # Not across a kink.
    assert made.derivative(x) == pytest.approx(np.mean(slopes), abs=1e-3)
    assert Complement(made).derivative(x) == -made.derivative(x)


def test_operations_nest_and_take_arrays():
    band = Intersection((Trapezoidal(0, 1, 2, 3), Complement(Trapezoidal(2, 3, 4, 5))))
    np.testing.assert_allclose(band.value([[0.5, 1.5], [2.5, 4.0]]), [[0.5, 1.0], [0.5, 0.0]])
    assert band.derivative([[0.5, 1.5]]).shape == (1, 2)


def test_the_union_of_nothing_is_empty_and_the_intersection_everything():
    np.testing.assert_array_equal(Union(()).value([1.0, 2.0]), [0.0, 0.0])
    np.testing.assert_array_equal(Intersection(()).value([1.0, 2.0]), [1.0, 1.0])
    np.testing.assert_array_equal(Union(()).derivative([1.0, 2.0]), [0.0, 0.0])
