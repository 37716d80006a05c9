import numpy as np
import pytest

import mala_drake.control.qp.soft_box_qp as mut


def test_the_objective_charges_soft_rows_only_where_they_are_exceeded():
    one = np.eye(1)
    problem = mut.SoftBoxQp(
        2 * one, one / np.sqrt(2), np.array([3.0]), -9 * one[0], 9 * one[0],
        rows=np.array([[1.0], [1.0], [1.0]]), bounds=np.array([0.5, 4.0, 0.0]), prices=np.array([8.0, 8.0, np.inf]),
    )  # fmt: skip
    assert problem.objective(np.array([2.0])) == pytest.approx(4.0 + 6.0 + 8.0 * 1.5**2 / 2)


def test_a_failure_answers_with_the_admissible_point_nearest_to_zero(make_qp):
    problem = make_qp(0)
    answer = mut.failed(problem)
    assert answer.status is mut.QpStatus.FAILED
    np.testing.assert_array_equal(answer.point, np.clip(0.0, problem.lower, problem.upper))
    assert not answer.row_duals.any()
