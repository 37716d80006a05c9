"""Elimination of the states: what the controls of the whole horizon do to the states of the whole horizon.

With dz_{k+1} = A_k dz_k + B_k du_k and dz_0 = 0, dz_k = S_k dU. The condensed problem has the controls alone as its
variables, 60 instead of 180, and no equality constraints (Bock & Plitt, IFAC World Congress 1984).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf, dtrtri

Vector = NDArray[np.float64]


def state_sensitivities(transitions: Vector, inputs: Vector) -> Vector:
    """S_k = d z_k / d U for the stages k = 1 ... N, shape (N, n, m N), zero for controls that come later.

    Args:
        transitions: A_0 ... A_{N-1}, shape (N, n, n); the first one is not used.
        inputs: B_0 ... B_{N-1}, shape (N, n, m).
    """
    horizon, n, m = inputs.shape
    sensitivities = np.zeros((horizon, n, m * horizon))
    stages = np.arange(horizon)
    sensitivities.reshape(horizon, n, horizon, m)[stages, :, stages, :] = inputs
    for transition, before, reached in zip(transitions[1:], sensitivities[:-1], sensitivities[1:], strict=True):
        reached += transition.dot(before)
    return sensitivities


def condensed_hessian(sensitivities: Vector, state_weights: Vector, control_weights: Vector) -> Vector:
    """H = sum_k S_k' diag(w_k) S_k + diag(r), shape (m N, m N).

    Args:
        sensitivities: S, shape (N, n, m N).
        state_weights: w_1 ... w_N >= 0, shape (N, n).
        control_weights: r > 0, shape (m N,).
    """
    horizon, n, size = sensitivities.shape
    root = (sensitivities * np.sqrt(state_weights)[:, :, None]).reshape(horizon * n, size)
    hessian = root.T @ root
    hessian.flat[:: size + 1] += control_weights
    return hessian


def costates(transitions: Vector, state_gradients: Vector) -> Vector:
    """The multipliers of the dynamics, lambda_N = g_N and lambda_k = g_k + A_k' lambda_{k+1}, shape (N, n).

    lambda_k is the derivative of the cost with respect to a displacement of z_k, the controls held.

    Args:
        transitions: A_0 ... A_{N-1}, shape (N, n, n).
        state_gradients: g_1 ... g_N, the cost's derivatives with respect to each state alone, shape (N, n).
    """
    multipliers = state_gradients.copy()
    for k in range(len(multipliers) - 2, -1, -1):
        multipliers[k] += multipliers[k + 1] @ transitions[k + 1]
    return multipliers


def whitening(hessian: Vector) -> Vector:
    """Upper triangular T with T' hessian T = I, the inverse of the Cholesky factor.

    The identity where the numbers overflow, so that a solve can fail in its own way.
    """
    factor, flaw = dpotrf(hessian.T)
    transform, singular = dtrtri(factor, overwrite_c=True)
    return np.eye(len(hessian)) if flaw or singular or not np.isfinite(transform).all() else transform
