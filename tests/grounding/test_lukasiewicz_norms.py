import numpy as np
import pytest

from mala_drake.grounding import LukasiewiczNorms


def test_three_half_truths_make_no_truth():
    assert LukasiewiczNorms().conjunction([0.5, 0.5, 0.5]) == 0.0
    np.testing.assert_array_equal(LukasiewiczNorms().conjunction_gradient([0.5, 0.5, 0.5]), np.zeros(3))


def test_what_is_lacking_adds_up():
    assert LukasiewiczNorms().conjunction([0.9, 0.8, 0.9]) == pytest.approx(0.6)


def test_a_truth_and_its_negation_exclude_each_other_and_leave_nothing_out():
    assert LukasiewiczNorms().conjunction([0.3, 0.7]) == pytest.approx(0.0, abs=1e-15)
    assert LukasiewiczNorms().disjunction([0.3, 0.7]) == pytest.approx(1.0)
