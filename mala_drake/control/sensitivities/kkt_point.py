"""A point on the central path: a trajectory that solves the barrier problem, with all its multipliers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mala_drake.control.parameters import MpcParameters
from mala_drake.messages import Message

from .sweeps import Factorisation

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class KktPoint(Message):
    """zeta = (w, lambda, mu) with kappa_nu(zeta, z_0, p) = 0 (paper, Sec. "MPC Sensitivities").

    Signs are the paper's: L = Phi + lambda' G + mu' H with G_{k+1} = f(z_k, u_k) - z_{k+1}, G_0 = (initial state) - z_0
    and H = (lower - u, u - upper) <= 0, so that mu >= 0 and mu (-H) = nu. (The paper's problem states h >= 0, its KKT
    system mu h + nu = 0; both hold for H = -h.) lambda_0 thus is the derivative of the optimal cost with respect to the
    initial state, and lower - upper multiplier is what `Solution.control_duals` holds.
    """

    initial_state: Vector  # Shape (6,).
    parameters: MpcParameters  # What was solved for.
    packed: Vector  # p in the order of `ParameterLayout`.
    lower: Vector  # Bounds of the controls, shape (N, 3); equal where a control is not a variable.
    upper: Vector
    barrier: float  # nu, in units of the cost.
    controls: Vector  # Shape (N, 3).
    states: Vector  # Shape (N + 1, 6).
    costates: Vector  # lambda_0 ... lambda_N, shape (N + 1, 6).
    lower_multipliers: Vector  # Shape (N, 3), >= 0.
    upper_multipliers: Vector  # Shape (N, 3), >= 0.
    factorisation: Factorisation
    converged: bool
    iterations: int  # Newton steps taken.
    residual: float  # Largest gradient of the Lagrange function, in variables of unit curvature.
    distance: float  # Largest change of a control from the solution that the search started at.

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which controls are variables, shape (N, 3)."""
        return self.lower < self.upper

    @property
    def lower_curvature(self) -> Vector:
        """Sigma of the lower bounds, mu / slack, shape (N, 3); 0 for controls that are no variables."""
        return _ratio(self.lower_multipliers, self.controls - self.lower)

    @property
    def upper_curvature(self) -> Vector:
        """Sigma of the upper bounds."""
        return _ratio(self.upper_multipliers, self.upper - self.controls)


def _ratio(multipliers: Vector, slacks: Vector) -> Vector:
    return np.divide(multipliers, slacks, out=np.zeros_like(slacks), where=slacks > 0)
