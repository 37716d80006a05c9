from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

import mala_drake.control.sensitivities.regularity as mut
from mala_drake.control import InputParameters
from mala_drake.control.sensitivities.interior_point import InteriorPoint
from mala_drake.control.sensitivities.kinks import KinkDistances


@pytest.fixture(scope="module")
def conditions(small):
    search = InteriorPoint(small)
    kinks = KinkDistances(search.functions)
    return lambda point: mut.regularity(point, search.sweeps, kinks)


def test_a_point_with_strictly_active_and_inactive_bounds_is_regular(small, conditions, solve, start, choose):
    point = solve(start, choose())
    found = conditions(point)
    assert found.regular
    assert found.differentiable
    assert found.strict_complementarity
    # The pivots are those of the dense Hessian with the active controls held: their product is its determinant.
    active = np.maximum(point.lower_multipliers, point.upper_multipliers).ravel() > 1e-2
    assert 0 < active.sum() < active.size
    hessian = small.hessian(point.controls.T, start, point.packed).full()[np.ix_(~active, ~active)]
    eigenvalues = np.linalg.eigvalsh(hessian)
    assert eigenvalues.min() > 0
    assert found.smallest_pivot >= eigenvalues.min()
    assert 1 < found.condition <= eigenvalues.max() / eigenvalues.min() * (1 + 1e-9)


def test_a_bound_that_is_just_reached_is_weakly_active(conditions, solve, start, choose):
    inner = solve(start, choose(obstacles=()))
    inactive = np.maximum(inner.lower_multipliers, inner.upper_multipliers).max(axis=0) < 1e-5
    assert inactive.any()
    control = int(np.flatnonzero(inactive)[-1])
    inputs = inner.parameters.inputs
    upper = inputs.upper.copy()
    upper[control] = inner.controls[:, control].max()
    stage = int(inner.controls[:, control].argmax())
    found = conditions(solve(start, choose(obstacles=(), inputs=InputParameters(inputs.lower, upper))))
    new = found.weakly_active & ~conditions(inner).weakly_active
    assert np.argwhere(new).tolist() == [[stage, control]]
    assert found.differentiable
    assert not found.regular


def test_bounds_that_coincide_violate_the_constraint_qualification(conditions, solve, start, choose):
    inputs = InputParameters(np.array([-1.0, 0.2, -0.8]), np.array([1.0, 0.2, 0.8]))
    found = conditions(solve(start, choose(inputs=inputs)))
    assert not found.licq
    assert not found.regular
    assert found.differentiable


@given(st.integers(0, 10**6))
@settings(max_examples=40)
def test_second_order_sufficiency_is_definiteness_of_the_dense_hessian(small, conditions, choose, seed):
    """At any controls well inside their bounds, where the cost may curve either way."""
    generator = np.random.default_rng(seed)
    state = generator.normal(0, [0.3, 0.3, 1.0, 0.8, 0.1, 0.5])
    chosen = choose(goal=generator.normal(0, 1, 6))
    controls = generator.uniform((-0.7, 0.2, -0.6), (0.7, 1.2, 0.6), (small.horizon, 3))
    point = InteriorPoint(small, iteration_limit=0).polish(controls, state, chosen)
    np.testing.assert_allclose(point.controls, controls, atol=1e-6)
    eigenvalues = np.linalg.eigvalsh(small.hessian(point.controls.T, state, point.packed).full())
    if np.abs(eigenvalues).min() < 1e-6 * np.abs(eigenvalues).max():
        return
    found = conditions(point)
    assert found.sosc == (eigenvalues.min() > 0)
    assert (found.smallest_pivot > 0) == found.sosc
    event("definite" if found.sosc else "indefinite")
    assert not found.differentiable


def test_what_follows_from_the_conditions():
    good = mut.Regularity(
        converged=True,
        licq=True,
        sosc=True,
        barrier_pivot=1.0,
        smallest_pivot=1.0,
        condition=2.0,
        weakly_active=np.zeros((4, 3), dtype=bool),
        kink_distance=1.0,
        residual=0.0,
        distance=0.0,
    )
    assert good.regular
    assert good.differentiable
    for name, value in (("converged", False), ("barrier_pivot", -1.0), ("barrier_pivot", np.nan)):
        assert not replace(good, **{name: value}).differentiable
    for name, value in (("licq", False), ("sosc", False), ("weakly_active", np.eye(4, 3) > 0), ("kink_distance", 1e-9)):
        broken = replace(good, **{name: value})
        assert broken.differentiable
        assert not broken.regular


def test_a_search_that_was_cut_short_is_not_differentiable(small, conditions, start, choose):
    point = InteriorPoint(small, iteration_limit=1).polish(np.zeros((small.horizon, 3)), start, choose())
    assert not conditions(point).converged
    assert not conditions(point).differentiable


def test_a_margin_on_the_edge_of_its_buffer_is_a_kink(conditions, solve, start, choose):
    free = solve(start, choose(obstacles=(), speed_limits=np.full(4, 5.0)))
    limits = np.full(4, 5.0)
    limits[2] = free.states[3, 3] + 0.05  # The buffer of path limits begins exactly here.
    found = conditions(solve(start, choose(obstacles=(), speed_limits=limits)))
    assert found.kink_distance < 1e-9
    assert not found.regular
    assert found.differentiable
    assert conditions(free).kink_distance > 1e-4
