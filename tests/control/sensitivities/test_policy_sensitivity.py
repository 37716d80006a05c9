from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mala_drake.control.sensitivities.policy_sensitivity as mut
from mala_drake.control import InputParameters, MakeSolver
from mala_drake.control.sensitivities import GROUPS, UPPER, Columns, SensitivityAnalysis
from mala_drake.control.sensitivities.interior_point import InteriorPoint
from mala_drake.control.sensitivities.parameter_terms import ParameterTerms
from mala_drake.control.sensitivities.stage_functions import StageFunctions


@pytest.fixture(scope="module")
def analysis(small):
    return SensitivityAnalysis(small)


@pytest.fixture(scope="module")
def search(small):
    return InteriorPoint(small, barrier=1e-4)


@given(st.integers(0, 10**6))
@settings(max_examples=25)
def test_it_is_the_first_row_of_the_primal_dual_sensitivity(analysis, search, choose, seed):
    """One sweep weighted by parameters against one sweep a parameter."""
    generator = np.random.default_rng(seed)
    state = generator.normal(0, [0.3, 0.3, 1.0, 0.6, 0.1, 0.5])
    point = search.polish(np.zeros((4, 3)), state, choose(goal=generator.normal(0, 1, 6)), barriers=(1e-1,))
    policy = analysis.policy(point)
    whole, conditions = analysis.primal_dual(point)
    if not conditions.differentiable:
        assert np.isnan(policy.jacobian).all()
        return
    scale = 1 + np.abs(whole.controls[0]).max()
    np.testing.assert_allclose(policy.jacobian, whole.controls[0], atol=1e-8 * scale)
    np.testing.assert_array_equal(policy.control, point.controls[0])


@pytest.mark.parametrize("group", [*GROUPS, "terminal.target", "stage.control_weights"])
def test_groups_are_parts_of_the_whole(small, solve, start, choose, group):
    point = solve(start, choose())
    columns, terms = Columns(small.layout), ParameterTerms(StageFunctions(small))
    whole = mut.policy_sensitivity(point, terms, columns, GROUPS)
    part = mut.policy_sensitivity(point, terms, columns, (group,))
    chosen = columns.of([group])
    np.testing.assert_array_equal(part[:, chosen], whole[:, chosen])
    other = [name for name in GROUPS if name not in group and {name, group.split(".")[0]} != {"terminal", "stage"}]
    np.testing.assert_array_equal(part[:, columns.of(other)], 0)


@pytest.fixture(scope="module")
def weak(small, solve, start, choose):
    """Parameters with the upper bound of the first yaw acceleration exactly where it would be without that bound."""
    chosen = choose(obstacles=(), goal=np.array([0.7, 0.2, 0.6, 0.6, 0.0, 0.2]))
    free = solve(start, chosen, 1e-9)
    assert 0.05 < free.controls[0, 2] < 0.75
    assert free.controls[0, 2] == free.controls[:, 2].max()
    inputs = InputParameters(chosen.inputs.lower, np.array([1.0, 1.5, free.controls[0, 2]]))
    return replace(chosen, inputs=inputs)


def test_at_a_weakly_active_bound_it_is_that_of_the_smooth_barrier_solution(analysis, solve, start, weak, perturbed):
    point = solve(start, weak, 1e-4)
    policy = analysis.policy(point)
    assert policy.regularity.weakly_active[0, 2]
    for name in ("terminal.target", UPPER, "initial_state"):
        for column in analysis.columns.of([name]):
            ends = [perturbed(point, column, size).controls[0] for size in (1e-6, -1e-6)]
            expected = (ends[0] - ends[1]) / 2e-6
            np.testing.assert_allclose(policy.jacobian[:, column], expected, atol=1e-5, err_msg=name)


def test_at_a_weakly_active_bound_it_lies_between_the_one_sided_derivatives_of_the_problem_itself(
    small, analysis, solve, start, weak
):
    """The exact policy has a kink there: SNOPT's on either side, and the barrier's in between."""
    solver = MakeSolver("snopt", small, tolerance=1e-10)
    middle = solver.solve(start, weak)
    entry, step = 2, 1e-4
    sides = []
    for size in (step, -step):
        target = weak.terminal.target.copy()
        target[entry] += size
        moved = replace(weak, terminal=replace(weak.terminal, target=target))
        sides.append((solver.solve(start, moved, middle.controls).controls[0, 2] - middle.controls[0, 2]) / size)
    column = analysis.columns.slices["terminal.target"].start + entry
    derivative = analysis.policy(solve(start, weak, 1e-8)).jacobian[2, column]
    low, high = sorted(sides)
    assert low == pytest.approx(0, abs=1e-3)  # Pushed against the bound it stays.
    assert high > 0.1
    assert low + 0.05 * high < derivative < 0.95 * high
