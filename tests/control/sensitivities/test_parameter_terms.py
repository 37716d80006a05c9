from __future__ import annotations

import casadi
import numpy as np
import pytest

import mala_drake.control.sensitivities.parameter_terms as mut
from mala_drake.control.sensitivities import GROUPS, Columns
from mala_drake.control.sensitivities.stage_functions import StageFunctions


@pytest.fixture(scope="module")
def terms(small):
    return mut.ParameterTerms(StageFunctions(small))


def test_they_are_the_dense_mixed_derivatives_of_the_lagrange_function(small, terms, reference, solve, start, choose):
    point = solve(start, choose())
    s = reference.symbols
    w = casadi.veccat(s["states"], s["controls"])
    lagrangian = reference.cost + casadi.dot(s["costates"], reference.equations)
    (dense,) = reference.evaluate([casadi.jacobian(casadi.gradient(lagrangian, w), s["parameters"])], point)
    horizon = small.horizon
    states, controls = (
        dense[: 6 * horizon + 6].reshape(horizon + 1, 6, -1),
        dense[6 * horizon + 6 :].reshape(horizon, 3, -1),
    )
    dynamics = small.layout.slices["dynamics"]

    own = np.zeros((horizon, 9, small.layout.size))
    for term in terms.nodes(point, GROUPS):
        for k in range(horizon):
            np.add.at(own[k], (term.rows, term.columns[k]), term.values[k])
    expected = np.concatenate((states[1:], controls), axis=1)
    expected[..., dynamics] = 0
    np.testing.assert_allclose(own, expected, atol=1e-9 * np.abs(dense).max())

    moved = terms.dynamics(point)
    np.testing.assert_allclose(moved.mixed[:, :6], states[:-1][..., dynamics], atol=1e-9)
    np.testing.assert_allclose(moved.mixed[:, 6:], controls[..., dynamics], atol=1e-9)
    (offset,) = reference.evaluate([casadi.jacobian(casadi.vec(reference.equations), s["parameters"])], point)
    np.testing.assert_allclose(moved.offset, offset.reshape(horizon + 1, 6, -1)[1:, :, dynamics], atol=1e-12)


def test_only_what_is_asked_for_is_computed(small, solve, start, choose):
    terms = mut.ParameterTerms(StageFunctions(small))
    point = solve(start, choose())
    columns = Columns(small.layout)
    assert terms.nodes(point, {"inputs", "dynamics"}) == []
    (tracking,) = terms.nodes(point, {"terminal"})
    assert set(tracking.columns.ravel()) <= set(columns.of(["terminal", "stage"]))
    (penalties,) = terms.nodes(point, {"constraints"})
    assert set(penalties.columns.ravel()) <= set(columns.of(["constraints"]))
