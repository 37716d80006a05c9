import copy
from dataclasses import replace

import numpy as np
import pytest

import mala_drake.control.solution as mut
from mala_drake.control.layout import ParameterLayout


def test_an_invalid_input_gives_a_solution_that_no_one_can_mistake_for_a_plan():
    solution = mut.invalid_solution(ParameterLayout(4, 2))
    assert solution.status == "invalid_input"
    assert not solution.success
    assert np.isnan(solution.states).all()
    assert (solution.controls == 0).all()
    assert solution.obstacle_duals.shape == (4, 2)
    assert copy.deepcopy(solution) is solution


def test_the_warm_start_moves_each_control_one_stage_up_and_holds_the_last(problem, parameters_toward):
    solution = mut.invalid_solution(ParameterLayout(3, 1))
    controls = np.arange(9.0).reshape(3, 3)
    object.__setattr__(solution, "controls", controls)
    np.testing.assert_array_equal(solution.shifted(), [[3, 4, 5], [6, 7, 8], [6, 7, 8]])


@pytest.mark.parametrize(
    ("status", "success", "usable"),
    [
        ("solved", True, True),
        ("inaccurate", True, True),
        ("iteration_limit", False, True),
        ("numerical", False, False),
        ("invalid_input", False, False),
    ],
)
def test_only_an_optimum_is_a_success_and_what_stopped_on_the_way_is_usable(status, success, usable):
    solution = replace(mut.invalid_solution(ParameterLayout(3, 1)), status=mut.Status(status))
    assert solution.success is success
    assert solution.usable is usable


def test_controls_that_are_not_finite_are_not_usable():
    broken = replace(mut.invalid_solution(ParameterLayout(3, 1)), status=mut.Status.ITERATION_LIMIT)
    assert not replace(broken, controls=np.full((3, 3), np.nan)).usable
