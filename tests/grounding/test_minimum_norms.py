import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.grounding import MinimumNorms


@given(st.floats(0.0, 1.0))
def test_the_same_truth_twice_is_the_same_truth_exactly(degree):
    assert MinimumNorms().conjunction([degree, degree]) == degree
    assert MinimumNorms().disjunction([degree, degree]) == degree


def test_only_the_first_of_equal_degrees_carries_the_gradient():
    np.testing.assert_array_equal(MinimumNorms().conjunction_gradient([0.9, 0.2, 0.2]), [0.0, 1.0, 0.0])
    np.testing.assert_array_equal(MinimumNorms().disjunction_gradient([0.9, 0.9, 0.2]), [1.0, 0.0, 0.0])
