"""The recursion against dense linear algebra; whole horizons are in test_sweeps.py."""

from __future__ import annotations

import casadi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.control.sensitivities.riccati as mut

entries = st.lists(st.floats(-3, 3), min_size=9, max_size=9)


@given(entries)
def test_the_symmetric_inverse_and_its_pivots(values):
    root = np.array(values).reshape(3, 3)
    matrix = root + root.T
    leading = [np.linalg.det(matrix[:k, :k]) for k in (1, 2, 3)]
    if min(map(abs, leading)) < 1e-3:
        return  # Without pivoting the factorisation need not exist.
    symbol = casadi.SX.sym("m", 3, 3)
    inverse, pivots = (part.full() for part in casadi.Function("f", [symbol], mut.symmetric_inverse(symbol))(matrix))
    np.testing.assert_allclose(inverse @ matrix, np.eye(3), atol=1e-6)
    assert sorted(np.sign(pivots[:, 0])) == sorted(np.sign(np.linalg.eigvalsh(matrix)))
    assert np.prod(pivots) == pytest.approx(leading[-1], rel=1e-6)


def test_one_stage_is_the_minimum_over_its_control():
    """min over du of dz'Pdz/2 + ..., of one linear-quadratic stage with all its terms, by eliminating du densely."""
    generator = np.random.default_rng(0)

    def symmetric(size):
        root = generator.normal(size=(size, size))
        return root @ root.T

    A, B, C = generator.normal(size=(6, 6)), generator.normal(size=(6, 3)), 0.1 * generator.normal(size=(3, 6))
    node, D, effort, tail = symmetric(6), symmetric(9), symmetric(3), symmetric(6)
    costate = casadi.SX.sym("costate", 6)
    stage = mut.backward_stage(
        mut.StageDerivatives(
            by_state=casadi.SX(A),
            by_control=casadi.SX(B),
            node_gradient=casadi.SX(6, 1),
            control_gradient=casadi.SX(3, 1),
            effort=casadi.SX(effort),
            curvature=mut.Curvature(casadi.SX(node), casadi.SX(C), casadi.SX(D)),
        ),
        costate,
        [],
    )
    sigma, slope = np.array([1.0, 0.0, 2.0]), np.array([0.3, -0.2, 0.1])
    before, _, linear, *rest = (v.full() for v in stage(tail, np.zeros(6), np.zeros(6), sigma, slope, np.ones(3)))
    gain, inverse, feed_forward = rest[6].T, rest[7], rest[10][:, 0]
    both = np.hstack((A, B))  # d z_{k+1} / d (z_k, u_k)
    pick = np.hstack((np.zeros((3, 6)), np.eye(3)))
    hessian = both.T @ (node + tail) @ both + D + pick.T @ (effort + np.diag(sigma)) @ pick
    hessian += pick.T @ C @ both + both.T @ C.T @ pick
    zz, uz, uu = hessian[:6, :6], hessian[6:, :6], hessian[6:, 6:]
    np.testing.assert_allclose(inverse, np.linalg.inv(uu), atol=1e-10)
    np.testing.assert_allclose(gain, np.linalg.solve(uu, uz), atol=1e-10)
    np.testing.assert_allclose(before, zz - uz.T @ np.linalg.solve(uu, uz), atol=1e-9)
    np.testing.assert_allclose(feed_forward, np.linalg.solve(uu, slope), atol=1e-10)
    np.testing.assert_allclose(linear[:, 0], -uz.T @ np.linalg.solve(uu, slope), atol=1e-10)
