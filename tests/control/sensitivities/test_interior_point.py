from __future__ import annotations

import numpy as np
import pytest

import mala_drake.control.sensitivities.interior_point as mut
from mala_drake.control import SOLVER_NAMES, MakeSolver


@pytest.mark.parametrize("name", SOLVER_NAMES)
def test_every_solver_s_solution_leads_to_the_same_point_in_a_few_steps(small, solve, start, choose, name):
    chosen = choose()
    solution = MakeSolver(name, small).solve(start, chosen)
    point = mut.InteriorPoint(small).polish(solution.controls, start, chosen, duals=solution.control_duals)
    assert point.converged
    assert point.iterations <= 10
    assert point.distance < 0.02
    np.testing.assert_allclose(point.controls, solve(start, chosen).controls, atol=1e-8)


def test_equal_inputs_give_equal_bytes(small, start, choose):
    chosen = choose()
    controls = np.full((small.horizon, 3), 0.2)
    first, second = (mut.InteriorPoint(small).polish(controls, start, chosen) for _ in range(2))
    assert first.controls.tobytes() == second.controls.tobytes()
    assert first.costates.tobytes() == second.costates.tobytes()


def test_the_distance_is_that_from_the_start(small, solve, start, choose):
    chosen = choose(obstacles=())
    far = np.zeros((small.horizon, 3))
    point = mut.InteriorPoint(small).polish(far, start, chosen, barriers=(1.0, 1e-3))
    assert point.converged
    assert point.distance == pytest.approx(np.abs(point.controls).max())
    np.testing.assert_allclose(point.controls, solve(start, chosen).controls, atol=1e-8)


def test_the_first_control_can_be_fixed(small, start, choose):
    point = mut.InteriorPoint(small).polish(
        np.zeros((small.horizon, 3)), start, choose(), first_control=(0.4, 0.0, 0.1), barriers=(1e-2,)
    )
    assert point.converged
    np.testing.assert_array_equal(point.controls[0], (0.4, 0.0, 0.1))
    assert not point.free[0].any()
    assert point.free[1:].all()
    np.testing.assert_array_equal(point.factorisation.gain[0], 0)
