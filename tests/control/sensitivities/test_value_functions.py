"""Values by brute force, Bellman identities, and gradients by differences (paper map C3)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

import mala_drake.control.sensitivities.value_functions as mut
from mala_drake.control import MakeSolver, OptimalControlProblem
from mala_drake.errors import BadInput


@pytest.fixture(scope="module")
def functions(small):
    return mut.ValueFunctions(small, MakeSolver("snopt", small, tolerance=1e-7))


@pytest.fixture(scope="module")
def chosen(choose):
    return choose(obstacles=())  # One way only: there is one optimum.


def tail(parameters):
    """The problem that is left after the first stage."""
    return replace(
        parameters,
        stage=replace(parameters.stage, references=parameters.stage.references[1:]),
        constraints=replace(parameters.constraints, speed_limits=parameters.constraints.speed_limits[1:]),
    )


def test_the_value_is_the_least_cost_another_optimiser_finds(small, functions, start, chosen):
    value = functions.value(start, chosen)
    packed = small.pack(start, chosen)

    def cost(flat):
        result, gradient = small.cost_and_gradient(flat.reshape(-1, 3).T, start, packed)
        return float(result), gradient.full().T.ravel()

    bounds = list(zip(chosen.inputs.lower, chosen.inputs.upper, strict=True)) * small.horizon
    other = minimize(cost, np.zeros(12), jac=True, bounds=bounds, method="L-BFGS-B", options={"ftol": 1e-15})
    assert value.converged
    assert value.value == pytest.approx(other.fun, abs=1e-4)
    np.testing.assert_allclose(value.action, other.x[:3], atol=1e-2)


def test_the_value_is_the_least_action_value_and_the_policy_attains_it(functions, start, chosen):
    value = functions.value(start, chosen)
    at_policy = functions.action_value(start, value.action, chosen)
    assert at_policy.value == pytest.approx(value.value, abs=1e-6)
    lower, upper = chosen.inputs.lower, chosen.inputs.upper
    generator = np.random.default_rng(0)
    near = np.clip(value.action + generator.normal(0, 0.05, (10, 3)), lower, upper)
    for action in (*generator.uniform(lower, upper, (20, 3)), *near):
        other = functions.action_value(start, action, chosen)
        assert other.converged
        assert other.value >= value.value - 1e-6
    # Searched for without derivatives, the best action is the policy's.
    search = minimize(
        lambda a: functions.action_value(start, np.clip(a, lower, upper), chosen).value,
        np.clip(value.action + 0.2, lower, upper),
        method="Nelder-Mead",
        options={"xatol": 1e-5, "fatol": 1e-9},
    )
    assert search.fun == pytest.approx(value.value, abs=1e-5)
    np.testing.assert_allclose(np.clip(search.x, lower, upper), value.action, atol=5e-3)


@pytest.mark.parametrize("action", [(0.2, 0.1, -0.3), (-0.4, 0.0, 0.5), (1.0, 0.0, -0.8), None])
def test_a_value_is_the_stage_cost_and_the_value_of_what_is_left(small, functions, start, chosen, action):
    """Q(s, a) = L(s, a) + V_{N-1}(f(s, a)), the second by its own problem and solver; V(s) at a = pi(s)."""
    value = functions.value(start, chosen) if action is None else functions.action_value(start, action, chosen)
    action = value.action
    shorter = OptimalControlProblem(horizon=small.horizon - 1, obstacle_slots=2)
    left = mut.ValueFunctions(shorter, MakeSolver("snopt", shorter, tolerance=1e-7))
    after = small.step(start, action, chosen.dynamics.vector).full()[:, 0]
    rest = left.value(after, tail(chosen))
    # The first stage's cost: that of the whole sequence less that of its tail.
    controls = np.vstack((action, rest.point.controls))
    whole, _ = small.cost_and_gradient(controls.T, start, small.pack(start, chosen))
    remainder, _ = shorter.cost_and_gradient(rest.point.controls.T, after, shorter.pack(after, tail(chosen)))
    stage = float(whole) - float(remainder)
    assert value.value == pytest.approx(stage + rest.value, abs=1e-6)
    np.testing.assert_allclose(value.point.controls[1:], rest.point.controls, atol=1e-6)


def test_gradients_are_differences_of_values(small, functions, start, choose, perturbed):
    """By the envelope theorem, for V at a point with active and inactive bounds and near an obstacle."""
    chosen = choose()
    value = functions.value(start, chosen)
    for column in range(functions.columns.size):
        costs = []
        for size in (1e-5, -1e-5):
            point = perturbed(value.point, column, size)
            cost, _ = small.cost_and_gradient(point.controls.T, point.initial_state, point.packed)
            costs.append(float(cost))
        expected = (costs[0] - costs[1]) / 2e-5
        assert value.gradient[column] == pytest.approx(expected, abs=1e-4 * (1 + abs(expected))), column


def test_action_gradients_are_differences_of_action_values(functions, start, chosen):
    action = np.array([0.3, 0.2, -0.3])
    value = functions.action_value(start, action, chosen)
    for i in range(3):
        ends = [functions.action_value(start, action + size * np.eye(3)[i], chosen).value for size in (1e-5, -1e-5)]
        assert value.action_gradient[i] == pytest.approx((ends[0] - ends[1]) / 2e-5, rel=1e-5)
    # A bound of the first control means nothing to a first control that is given.
    best = functions.value(start, chosen)
    at_policy = functions.action_value(start, best.action, chosen)
    np.testing.assert_allclose(best.action_gradient, at_policy.action_gradient, atol=1e-5)


@pytest.mark.parametrize("action", [(2.0, 0.0, 0.0), (0.0, -0.1, 0.0), (np.nan, 0.0, 0.0), (0.0, 0.0)])
def test_an_action_outside_of_the_input_set_is_refused(functions, start, chosen, action):
    with pytest.raises(BadInput, match="action"):
        functions.action_value(start, action, chosen)
