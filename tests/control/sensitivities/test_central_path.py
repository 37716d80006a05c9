from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

import mala_drake.control.sensitivities.central_path as mut
from mala_drake.control.sensitivities.stage_functions import StageFunctions
from mala_drake.control.sensitivities.sweeps import Sweeps


@pytest.fixture(scope="module")
def sweeps(small):
    return Sweeps(StageFunctions(small))


def search(small, sweeps, state, chosen):
    sweeps.set_parameters(state, small.pack(state, chosen))
    shape = (small.horizon, 3)
    lower, upper = (np.broadcast_to(b, shape).copy() for b in (chosen.inputs.lower, chosen.inputs.upper))
    return mut.CentralPathSearch(sweeps, lower, upper, 2 * chosen.stage.control_weights)


def test_it_minimises_the_barrier_function(small, sweeps, start, choose):
    chosen, barrier = choose(), 0.1
    path = search(small, sweeps, start, chosen)
    nothing = np.zeros((small.horizon, 3))
    point = path.run(nothing, nothing, barrier, 60)
    assert point.converged
    packed = small.pack(start, chosen)

    def function(flat):
        controls = flat.reshape(-1, 3)
        slacks = np.minimum(controls - chosen.inputs.lower, chosen.inputs.upper - controls)
        if slacks.min() <= 0:
            return 1e9
        cost, _ = small.cost_and_gradient(controls.T, start, packed)
        return float(cost) - barrier * np.log((controls - chosen.inputs.lower) * (chosen.inputs.upper - controls)).sum()

    best = minimize(function, point.controls.ravel() * 0.98 + 0.01, method="Nelder-Mead", options={"maxfev": 20_000})
    assert function(point.controls.ravel()) <= best.fun + 1e-6
    best = minimize(function, point.controls.ravel(), method="Powell", options={"xtol": 1e-8, "ftol": 1e-14})
    np.testing.assert_allclose(best.x, point.controls.ravel(), atol=1e-3)


@given(st.integers(0, 10**6))
@settings(max_examples=25)
def test_it_gets_there_from_anywhere_and_only_downhill(small, sweeps, choose, seed):
    generator = np.random.default_rng(seed)
    state = generator.normal(0, [0.3, 0.3, 1.0, 0.6, 0.1, 0.5])
    chosen = choose(goal=generator.normal(0, 1, 6))
    path = search(small, sweeps, state, chosen)
    controls = generator.uniform(chosen.inputs.lower, chosen.inputs.upper, (small.horizon, 3))
    point = path.run(controls, np.zeros_like(controls), 1e-2, 200)
    assert point.converged
    first = path._first(controls, np.zeros_like(controls), 1e-2)
    assert path._evaluated(point.controls, first.lower, first.upper, 1e-2).merit <= first.merit + 1e-9
    assert (point.controls > chosen.inputs.lower).all()
    assert (point.controls < chosen.inputs.upper).all()


def test_the_active_set_may_be_wrong_at_the_start(small, sweeps, start, choose):
    path = search(small, sweeps, start, choose(obstacles=()))  # One way only: there is one optimum.
    nothing = np.zeros((small.horizon, 3))
    point = path.run(nothing, nothing, 1e-7, 100)
    duals = point.lower_multipliers - point.upper_multipliers
    again = path.run(point.controls, duals, 1e-7, 100)
    assert again.iterations <= 2
    # Every bound claimed active that is not, and the other way round.
    swapped = np.where(np.abs(duals) > 1e-3, 0.0, 50.0)
    other = path.run(np.clip(point.controls, -0.5, 0.5), swapped, 1e-7, 100)
    assert other.converged
    np.testing.assert_allclose(other.controls, point.controls, atol=1e-9)


def test_a_control_between_equal_bounds_stays(small, sweeps, start, choose):
    chosen = choose()
    sweeps.set_parameters(start, small.pack(start, chosen))
    shape = (small.horizon, 3)
    lower, upper = (np.broadcast_to(b, shape).copy() for b in (chosen.inputs.lower, chosen.inputs.upper))
    lower[0] = upper[0] = (0.3, 0.1, -0.2)
    path = mut.CentralPathSearch(sweeps, lower, upper, 2 * chosen.stage.control_weights)
    point = path.run(np.zeros(shape), np.zeros(shape), 1e-6, 100)
    assert point.converged
    np.testing.assert_array_equal(point.controls[0], (0.3, 0.1, -0.2))
    np.testing.assert_array_equal(point.lower_multipliers[0], 0)
    np.testing.assert_array_equal(point.upper_multipliers[0], 0)


def test_a_limit_on_iterations_and_numbers_that_are_not_finite_end_it_unconverged(small, sweeps, start, choose):
    path = search(small, sweeps, start, choose())
    nothing = np.zeros((small.horizon, 3))
    point = path.run(nothing, nothing, 1e-7, 1)
    assert (point.converged, point.iterations) == (False, 1)
    with np.errstate(all="ignore"):
        path = search(small, sweeps, np.full(6, np.nan), choose())
        assert not path.run(nothing, nothing, 1e-7, 50).converged
