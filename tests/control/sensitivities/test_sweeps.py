"""Stage by stage against the condensed problem: its cost, gradient and Hessian are CasADi's of single shooting."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mala_drake.control.sensitivities.sweeps as mut
from mala_drake.control.sensitivities.stage_functions import StageFunctions


@pytest.fixture(scope="module")
def sweeps(small):
    return mut.Sweeps(StageFunctions(small))


def random_case(small, choose, seed):
    generator = np.random.default_rng(seed)
    state = generator.normal(0, [0.3, 0.3, 1.0, 0.8, 0.1, 0.5])
    chosen = choose(goal=generator.normal(0, 1, 6))
    controls = generator.uniform(chosen.inputs.lower, chosen.inputs.upper, (small.horizon, 3))
    return state, small.pack(state, chosen), controls


@given(st.integers(0, 10**6))
@settings(max_examples=30)
def test_cost_gradient_and_newton_step_are_those_of_single_shooting(small, sweeps, choose, seed):
    state, packed, controls = random_case(small, choose, seed)
    cost, gradient = (value.full() for value in small.cost_and_gradient(controls.T, state, packed))
    hessian = small.hessian(controls.T, state, packed).full()
    sweeps.set_parameters(state, packed)
    states, own_cost = sweeps.forward(controls)
    np.testing.assert_allclose(states, np.array(small.trajectory(controls.T, state, packed)[0].full().T), atol=1e-12)
    weights, reference = (packed[small.layout.slices[n]][:6] for n in ("stage.state_weights", "stage.references"))
    assert own_cost + weights @ (state - reference) ** 2 == pytest.approx(cost[0, 0], rel=1e-10)

    generator = np.random.default_rng(seed)
    curvature, slope = generator.uniform(0, 100, controls.shape), generator.normal(0, 10, controls.shape)
    free = (generator.random(controls.shape) < 0.8).astype(float)
    f = sweeps.backward(states, controls, curvature=curvature, slope=slope, free=free)
    np.testing.assert_allclose(f.gradient, gradient.T + slope, atol=1e-9 * (1 + np.abs(gradient).max()))
    keep = free.ravel() > 0
    reduced = (hessian + np.diag(curvature.ravel()))[np.ix_(keep, keep)]
    # The signs of the pivots are those of the eigenvalues; near zero rounding decides.
    eigenvalues = np.linalg.eigvalsh(reduced)
    if np.abs(eigenvalues).min() > 1e-6 * np.abs(eigenvalues).max():
        assert (f.pivots > 0).all() == (eigenvalues > 0).all()
    if eigenvalues.min() > 1e-3:
        step = sweeps.newton_step(f)
        np.testing.assert_array_equal(step[free == 0], 0)
        expected = np.linalg.solve(reduced, -f.gradient.ravel()[keep])
        np.testing.assert_allclose(step.ravel()[keep], expected, atol=1e-6 * (1 + np.abs(expected).max()))


def test_costates_are_the_derivative_of_the_cost_to_go(small, sweeps, choose):
    state, packed, controls = random_case(small, choose, 3)
    sweeps.set_parameters(state, packed)
    states, _ = sweeps.forward(controls)
    nothing, free = np.zeros_like(controls), np.ones_like(controls)
    f = sweeps.backward(states, controls, curvature=nothing, slope=nothing, free=free)
    for i in range(6):
        ends = []
        for size in (1e-6, -1e-6):
            sweeps.set_parameters(state + size * np.eye(6)[i], packed)
            ends.append(sweeps.forward(controls)[1])
        assert f.initial_costate[i] == pytest.approx((ends[0] - ends[1]) / 2e-6, rel=1e-5, abs=1e-4)


def test_results_survive_the_next_sweep(small, sweeps, choose):
    nothing, free = np.zeros((small.horizon, 3)), np.ones((small.horizon, 3))
    kept = []
    for seed in (1, 2):
        state, packed, controls = random_case(small, choose, seed)
        sweeps.set_parameters(state, packed)
        states, _ = sweeps.forward(controls)
        f = sweeps.backward(states, controls, curvature=nothing, slope=nothing, free=free)
        kept.append((f, f.gradient.copy(), states, states.copy()))
    for f, gradient, states, copy in kept:
        np.testing.assert_array_equal(f.gradient, gradient)
        np.testing.assert_array_equal(states, copy)


@given(st.integers(0, 10**6))
@settings(max_examples=20)
def test_the_convex_model_is_positive_definite_everywhere_with_the_same_gradient(small, sweeps, choose, seed):
    state, packed, controls = random_case(small, choose, seed)
    sweeps.set_parameters(state, packed)
    states, _ = sweeps.forward(controls)
    arguments = {"curvature": np.zeros_like(controls), "slope": np.zeros_like(controls), "free": np.ones_like(controls)}
    exact = sweeps.backward(states, controls, **arguments)
    convex = sweeps.backward(states, controls, **arguments, convex=True)
    assert convex.pivots.min() > 0
    np.testing.assert_allclose(convex.gradient, exact.gradient, rtol=1e-12, atol=1e-9)
    assert (sweeps.newton_step(convex) * convex.gradient).sum() < 0
