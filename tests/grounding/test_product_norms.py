import numpy as np

from mala_drake.grounding import ProductNorms


def test_a_zero_keeps_its_own_gradient():
    np.testing.assert_allclose(ProductNorms().conjunction_gradient([0.5, 0.0, 0.4]), [0.0, 0.2, 0.0])


def test_two_zeros_leave_no_gradient():
    np.testing.assert_array_equal(ProductNorms().conjunction_gradient([0.0, 0.0, 0.4]), [0.0, 0.0, 0.0])


def test_a_certainty_takes_the_gradient_of_a_disjunction_from_all_others():
    np.testing.assert_allclose(ProductNorms().disjunction_gradient([1.0, 0.3]), [0.7, 0.0])
