import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.grounding import ArgmaxThreshold, Hysteresis, Threshold

degrees = st.lists(st.floats(0.0, 1.0), max_size=6)


def test_the_threshold_itself_is_true():
    np.testing.assert_array_equal(Threshold().crisp([0.69, 0.7, 1.0]), [False, True, True])


def test_argmax_takes_the_best_one_only():
    np.testing.assert_array_equal(ArgmaxThreshold().crisp([0.75, 0.9, 0.8]), [False, True, False])


def test_argmax_takes_none_below_the_threshold():
    np.testing.assert_array_equal(ArgmaxThreshold().crisp([0.69, 0.1]), [False, False])


def test_of_equal_degrees_the_first_wins():
    np.testing.assert_array_equal(ArgmaxThreshold().crisp([0.2, 1.0, 1.0]), [False, True, False])


@given(degrees)
def test_argmax_is_never_true_where_the_threshold_is_not(values):
    best, all_above = ArgmaxThreshold().crisp(values), Threshold().crisp(values)
    assert np.all(all_above[best])
    assert best.sum() == min(1, all_above.sum())


def test_hysteresis_keeps_what_was_true_until_the_lower_threshold():
    hysteresis = Hysteresis(lower=0.4, upper=0.7)
    truth = np.array([False])
    history = []
    for degree in (0.6, 0.71, 0.6, 0.4, 0.39, 0.6):
        truth = hysteresis.crisp([degree], previous=truth)
        history.append(bool(truth[0]))
    assert history == [False, True, True, True, False, False]


@given(degrees)
def test_hysteresis_without_memory_or_width_is_a_threshold(values):
    np.testing.assert_array_equal(Hysteresis().crisp(values), Threshold().crisp(values))
    held = np.ones(len(values), dtype=bool)
    np.testing.assert_array_equal(Hysteresis(0.7, 0.7).crisp(values, previous=held), Threshold().crisp(values))


@pytest.mark.parametrize("operation", [Threshold(), ArgmaxThreshold(), Hysteresis()])
def test_what_is_not_a_number_is_never_true(operation):
    truths = operation.crisp([np.nan, 0.9], previous=[True, True])
    np.testing.assert_array_equal(truths, [False, True])
    assert operation.crisp([]).shape == (0,)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Threshold(0.0),  # Everything would be true of nothing.
        lambda: Threshold(1.1),
        lambda: ArgmaxThreshold(float("nan")),
        lambda: Hysteresis(lower=0.8, upper=0.7),
    ],
)
def test_thresholds_that_are_no_degrees_are_refused(make):
    with pytest.raises(BadInput):
        make()
