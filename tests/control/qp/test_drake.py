import dataclasses

import numpy as np
import pytest

import mala_drake.control.qp.drake as mut
from mala_drake.control.qp import QpStatus
from mala_drake.control.qp.daqp import DaqpSolver

SOLVERS = [mut.ClarabelQpSolver, mut.OsqpQpSolver]


@pytest.mark.parametrize("make", SOLVERS)
@pytest.mark.parametrize(("soft", "hard"), [(10, 3), (10, 0), (0, 2), (0, 0)])
def test_drakes_solvers_agree_with_daqp_on_point_and_multipliers(make_qp, make, soft, hard):
    for seed in range(3):
        problem = make_qp(seed, soft=soft, hard=hard)
        one, two = DaqpSolver().solve(problem), make().solve(problem)
        assert two.status is QpStatus.SOLVED
        np.testing.assert_allclose(two.point, one.point, atol=1e-4)
        np.testing.assert_allclose(two.box_duals, one.box_duals, atol=1e-2 * (1 + np.abs(one.box_duals).max()))
        np.testing.assert_allclose(two.row_duals, one.row_duals, atol=1e-2 * (1 + np.abs(one.row_duals).max(initial=0)))
        assert two.iterations > 0


@pytest.mark.parametrize("make", SOLVERS)
def test_what_cannot_be_solved_is_told(make_qp, make):
    problem = make_qp(0, soft=2, hard=1)
    assert make().solve(dataclasses.replace(problem, bounds=problem.bounds - 100.0)).status is QpStatus.INFEASIBLE
    assert make().solve(dataclasses.replace(problem, gradient=problem.gradient * np.nan)).status is QpStatus.FAILED
