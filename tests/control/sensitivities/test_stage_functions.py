import casadi
import numpy as np
import pytest

import mala_drake.control.sensitivities.stage_functions as mut


def test_functions_are_created_when_first_used(small):
    functions = mut.StageFunctions(small)
    assert not {"forward", "backward", "convex_backward", "newton_step", "parameter_gradient"} & set(vars(functions))
    assert functions.forward is functions.forward


def test_the_gradient_with_respect_to_the_data_is_the_difference_of_the_lagrange_function(small, solve, start, choose):
    point = solve(start, choose())
    functions = mut.StageFunctions(small)
    data = point.packed[functions.data.sources]
    rows = (point.controls, point.states[1:], point.costates[1:], point.states[:-1])
    gradient = functions.parameter_gradient(*(r.T for r in rows), data.T).full()[:, 1]
    stage = [r[1] for r in rows]
    symbols = [functions.control, functions.reached, functions.costate, functions.state, functions.numbers]
    lagrangian = functions.tracking + functions.effort + functions.penalties
    lagrangian += casadi.dot(functions.costate, functions.next_state)
    value = casadi.Function("lagrangian", symbols, [lagrangian])
    for i in range(functions.data.size):
        step = 1e-6 * np.eye(functions.data.size)[i]
        expected = (value(*stage, data[1] + step) - value(*stage, data[1] - step)) / 2e-6
        assert gradient[i] == pytest.approx(float(expected), abs=1e-5 * (1 + abs(float(expected))))
