"""One stage of the backward Riccati recursion that factorises the KKT system.

With dz_{k+1} = A dz_k + B du_k the cost to go P_{k+1} of the reached state, its node included, gives the model of the
stage: M = 2R + sigma + D_uu + B'PB + CB + (CB)' in du_k, G = D_uz + (B'P + C) A between du_k and dz_k. Its minimiser
is du_k = -K dz_k - M^-1 (rest) with K = M^-1 G (Rawlings, Mayne, Diehl, Model Predictive Control, 2nd ed., Sec. 8.8).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi

from mala_drake.buffered_function import densified
from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE


@dataclass(frozen=True)
class Curvature:
    """Second derivatives of a stage."""

    node: casadi.SX  # Of its cost with respect to z_{k+1}, shape (6, 6).
    cross: casadi.SX  # C = d^2 cost / du_k dz_{k+1}, shape (3, 6).
    dynamics: casadi.SX  # D, of lambda_{k+1}' f with respect to (z_k, u_k), shape (9, 9), in terms of the costate.


@dataclass(frozen=True)
class StageDerivatives:
    """What the recursion needs to know of a stage."""

    by_state: casadi.SX  # A.
    by_control: casadi.SX  # B.
    node_gradient: casadi.SX  # Of the stage's cost with respect to z_{k+1}.
    control_gradient: casadi.SX  # And to u_k.
    effort: casadi.SX  # 2 R.
    curvature: Curvature


def backward_stage(stage: StageDerivatives, costate: casadi.SX, arguments: list[casadi.SX]) -> casadi.Function:
    """(P, lambda, s; arguments, sigma, b, free) -> (P, lambda, s) before the node of the stage, and what it gives.

    That is lambda_{k+1}, the gradient with respect to u_k, P_{k+1}', A', B', C', K', M^-1, the pivots of M, the
    diagonal of M without sigma, and the feed-forward of the Newton step. Matrices are transposed, as rows are stored.

    Args:
        stage: the derivatives.
        costate: the symbol of lambda_{k+1} in them.
        arguments: the symbols z_k, u_k, z_{k+1} and the stage's data. Sigma is the curvature of what is added to the
            cost of u_k, and b its gradient; free is 0 for a control that is no variable, else 1.
    """
    n, m = STATE_SIZE, CONTROL_SIZE
    value, multiplier, linear = casadi.SX.sym("P", n, n), casadi.SX.sym("l", n), casadi.SX.sym("s", n)
    sigma, slope, free = (casadi.SX.sym(name, m) for name in ("sigma", "b", "free"))
    A, B, C = stage.by_state, stage.by_control, stage.curvature.cross
    reached_costate = multiplier + stage.node_gradient
    D = casadi.substitute(stage.curvature.dynamics, costate, reached_costate)
    P = value + stage.curvature.node
    transfer = B.T @ P + C
    bare = stage.effort + D[n:, n:] + transfer @ B + (C @ B).T
    mask = casadi.diag(free)
    M = mask @ (bare + casadi.diag(sigma)) @ mask + casadi.diag(1 - free)
    G = mask @ (D[n:, :n] + transfer @ A)
    inverse, pivots = symmetric_inverse(M)
    inverse = mask @ inverse @ mask
    gain = inverse @ G
    gradient = stage.control_gradient + B.T @ reached_costate + slope
    rest = gradient + B.T @ linear
    before = A.T @ P @ A + D[:n, :n] - G.T @ gain
    outputs = [
        (before + before.T) / 2,
        A.T @ reached_costate,
        A.T @ linear - gain.T @ rest,
        *(reached_costate, gradient, P.T, A.T, B.T, C.T, gain.T, inverse, pivots, casadi.diag(bare), inverse @ rest),
    ]
    return densified("stage", [value, multiplier, linear, *arguments, sigma, slope, free], outputs)


def symmetric_inverse(matrix: casadi.SX) -> tuple[casadi.SX, casadi.SX]:
    """The inverse of a symmetric matrix by L D L', with D's diagonal, whose signs are those of the eigenvalues."""
    size = matrix.shape[0]
    lower, pivots = casadi.SX.eye(size), casadi.SX.zeros(size)
    for j in range(size):
        pivots[j] = matrix[j, j] - sum((lower[j, k] ** 2 * pivots[k] for k in range(j)), casadi.SX(0))
        for i in range(j + 1, size):
            known = sum((lower[i, k] * lower[j, k] * pivots[k] for k in range(j)), casadi.SX(0))
            lower[i, j] = (matrix[i, j] - known) / pivots[j]
    inverse_lower = casadi.SX.eye(size)
    for j in range(size):
        for i in range(j + 1, size):
            inverse_lower[i, j] = -sum((lower[i, k] * inverse_lower[k, j] for k in range(j, i)), casadi.SX(0))
    return inverse_lower.T @ casadi.diag(1 / pivots) @ inverse_lower, pivots
