import numpy as np
import pytest

import mala_drake.control.globalisation as mut


def evaluate(controls):
    """The merit sqrt(1 + x^2) of one control: Newton's full step diverges from |x| > 1."""
    x = float(controls[0, 0])
    with np.errstate(invalid="ignore"):
        value = np.sqrt(1 + x * x) if abs(x) < 50 else np.nan
    return mut.Iterate(controls, value, np.array([[x / value]]))


def test_a_full_step_that_decreases_enough_is_taken():
    found = mut.line_search(evaluate, evaluate(np.array([[0.5]])), np.array([[-0.5]]), -0.1)
    assert found.controls[0, 0] == 0.0


def test_a_step_too_long_is_shortened_until_the_merit_falls():
    start = evaluate(np.array([[3.0]]))
    newton = np.array([[-3.0 * (1 + 9.0)]])
    found = mut.line_search(evaluate, start, newton, float((start.gradient * newton)[0, 0]))
    assert found.cost < start.cost
    assert -3.0 < found.controls[0, 0] < 3.0


def test_a_candidate_that_does_not_exist_is_no_iterate():
    start = evaluate(np.array([[40.0]]))
    found = mut.line_search(evaluate, start, np.array([[-95.0]]), -1.0)
    assert found.finite
    assert found.cost < start.cost


def test_a_direction_of_ascent_gives_none():
    start = evaluate(np.array([[1.0]]))
    assert mut.line_search(evaluate, start, np.array([[1.0]]), -1.0) is None


@pytest.mark.parametrize("merit", [np.nan, np.inf])
def test_an_iterate_without_a_merit_is_not_finite(merit):
    assert not mut.Iterate(np.zeros((1, 1)), merit, np.zeros((1, 1))).finite


def test_a_violation_costs_its_price():
    start = mut.Iterate(np.array([[1.0]]), 2.0, np.array([[-1.0]]))

    def towards_a_wall_at_two(controls):
        x = float(controls[0, 0])
        return mut.Iterate(controls, 3.0 - x, np.array([[-1.0]]), max(x - 2.0, 0.0))

    cheap = mut.line_search(towards_a_wall_at_two, start, np.array([[4.0]]), -4.0, price=0.1)
    dear = mut.line_search(towards_a_wall_at_two, start, np.array([[4.0]]), -4.0, price=10.0)
    assert cheap.violation == 3.0
    assert dear.violation == 0.0
