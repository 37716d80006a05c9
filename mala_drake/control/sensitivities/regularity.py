"""Whether the implicit function theorem holds at a point, and by how much.

LICQ: the gradients of z_{k+1} = f and of the active bounds are linearly independent whenever no control has both of its
bounds active, because every state has its own equation and every control its own bounds. So LICQ fails exactly where
the input set has no interior. Second-order sufficiency: the Hessian with the strictly active controls held is positive
definite; its block L D L' has the pivots given here (the strong condition: weakly active controls count as free).
Strict complementarity: a bound's share of the curvature of its control, sigma (M^-1)_ii with sigma = mu / slack and M
that of the later and the other controls' best answer, tends to 0 where the bound is inactive and to 1 where it is
active. In between it is weakly active: the sensitivity blends both sides' and depends on nu, which is the paper's
smooth manifold through a kink of the policy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mala_drake.messages import Message

from .kinks import KinkDistances
from .kkt_point import KktPoint
from .sweeps import Sweeps

Vector = NDArray[np.float64]

_BLEND = 0.01  # Shares of the curvature between this and one minus it are weakly active.
_KINK = 1e-6  # Metres, m/s, ...: a margin this close to a change of curvature is on it.
_SMALLEST_PIVOT = 1e-8  # Relative to the largest one.


@dataclass(frozen=True, slots=True, eq=False)
class Regularity(Message):
    """The conditions of the implicit function theorem at one point."""

    converged: bool  # The point solves the barrier system.
    licq: bool  # No control has both bounds active.
    sosc: bool  # The reduced Hessian is positive definite.
    barrier_pivot: float  # The smallest one of the barrier system, positive where its solution has a derivative.
    smallest_pivot: float  # Of the reduced Hessian; not positive where second-order sufficiency fails.
    condition: float  # Largest over smallest pivot, a lower estimate of the reduced Hessian's condition number.
    weakly_active: NDArray[np.bool_]  # Shape (N, 3).
    kink_distance: float  # From a margin that counts to the nearest jump of its penalty's curvature.
    residual: float  # Of the KKT system.
    distance: float  # Between the solution and the point on the central path.

    @property
    def strict_complementarity(self) -> bool:
        """Whether no bound is weakly active."""
        return not bool(self.weakly_active.any())

    @property
    def differentiable(self) -> bool:
        """Whether the barrier solution is a strict minimum and has a derivative: without it sensitivities are nan.

        A large nu makes many bounds weakly active, and a control that such a bound holds can curve the cost downward
        while the barrier's own curvature outweighs that: then this holds and second-order sufficiency does not.
        """
        return self.converged and self.barrier_pivot > 0

    @property
    def regular(self) -> bool:
        """Whether all holds, so that the sensitivity is also that of the problem itself, up to the order of nu."""
        smooth = self.kink_distance > _KINK
        return self.differentiable and self.sosc and self.licq and self.strict_complementarity and smooth


def regularity(point: KktPoint, sweeps: Sweeps, kinks: KinkDistances) -> Regularity:
    """The conditions at `point`, with work arrays of its problem."""
    share = np.maximum(point.lower_curvature, point.upper_curvature) * np.diagonal(point.factorisation.inverse, 0, 1, 2)
    held = ~point.free | (share >= 1 - _BLEND)
    nothing = np.zeros_like(share)
    sweeps.set_parameters(point.initial_state, point.packed)
    reduced = sweeps.backward(
        point.states, point.controls, curvature=nothing, slope=nothing, free=(~held).astype(float)
    )
    pivots = reduced.pivots[~held]
    smallest, largest = float(pivots.min(initial=np.inf)), float(pivots.max(initial=0.0))
    inputs = point.parameters.inputs
    return Regularity(
        converged=point.converged,
        licq=bool((inputs.lower < inputs.upper).all()),
        # Not a number compares as failed; with every control held there is nothing left to curve.
        sosc=pivots.size == 0 or smallest > _SMALLEST_PIVOT * largest,
        barrier_pivot=float(point.factorisation.pivots.min()),
        smallest_pivot=smallest,
        condition=largest / smallest if smallest > 0 else np.inf,
        weakly_active=~held & (share > _BLEND),
        kink_distance=kinks.nearest(point),
        residual=point.residual,
        distance=point.distance,
    )
