"""The convex model of the cost round one iterate, and the quadratic program that minimises it.

The cost is h(c(U)) with h convex and c smooth: the model linearises c and keeps h (Burke, Mathematical Programming 33,
1985). Where a penalty is past its quadratic piece, h's linear one is replaced by the quadratic that touches it at the
iterate and majorises it, so that the model is a quadratic program and its minimiser is a direction of descent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .condensing import condensed_hessian, state_sensitivities, whitening
from .linearisation import Linearisation
from .model import CONTROL_SIZE, ControlIndex, StateIndex
from .parameters import InputParameters
from .qp import QpSolver, QpStatus, SoftBoxQp

Vector = NDArray[np.float64]
Mask = NDArray[np.bool_]

AT_BOUND = 1e-9
"""Distance to a bound of the input set that is round-off."""

_REACH = 0.1  # Rows whose excess is below minus this wait until a step of the others makes it positive.
_CAUTION = 0.25  # See `_reverse_braking`.
_PASSES = 4  # At most, until no row that waits is exceeded.


class Condensed:
    """The part of the model that references, limits and obstacles do not change: what *preparation* prepares."""

    def __init__(self, linearisation: Linearisation) -> None:
        lin = linearisation
        self.sensitivities = state_sensitivities(lin.transitions, lin.inputs)
        self.hessian = condensed_hessian(self.sensitivities, lin.state_weights, lin.control_weights.ravel())
        if lin.couplings.any():
            self.hessian += _reverse_braking(lin, self.sensitivities)
        self.transform = whitening(self.hessian)


@dataclass(frozen=True, slots=True, eq=False)
class Multipliers:
    """Of the model's quadratic program; those of another iterate are a good guess of the active set."""

    box: Vector  # Shape (3 N,).
    rows: Vector  # Of the penalties, shape (N, R).
    hard: Vector  # Of hard clearance, shape (N, M).


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """A step of the controls with what it is worth."""

    status: QpStatus
    direction: Vector  # dU, shape (N, 3).
    decrease: float  # Model value at dU less that at zero: <= 0, and no less than the cost's slope along dU.
    multipliers: Multipliers
    wall_force: Vector  # The share of hard clearance in the Lagrangian's gradient, shape (N, 3).


class StepModel:
    """The model at one iterate: condensed tracking, and the rows that may matter."""

    def __init__(self, linearisation: Linearisation, condensed: Condensed) -> None:
        """Makes the model.

        Args:
            linearisation: at the iterate.
            condensed: of the same linearisation, or of one nearby. All of the model then uses the sensitivities of that
                one: exact gradients beside inexact Hessians go far astray in problems as stiff as this one.
        """
        self._lin = lin = linearisation
        self._condensed = condensed
        flat = condensed.sensitivities.reshape(-1, len(condensed.hessian))
        self._gradient = lin.state_gradients.ravel() @ flat + lin.control_gradients.ravel()
        self._prices = lin.prices / np.maximum(lin.excesses, lin.widths)
        self._priced = lin.prices > 0
        self._near = self._priced & (lin.excesses > -_REACH)
        self._near_slopes = self._row_slopes(self._near)
        self._active = self._near & (lin.excesses > 0)
        self._active_slopes = self._near_slopes[self._active[self._near]]

    def gradient(self) -> Vector:
        """The cost's gradient at the iterate, shape (3 N,); exact where the condensed part is the iterate's own."""
        return self._gradient + (self._prices * self._lin.excesses)[self._active] @ self._active_slopes

    def curvature(self) -> Vector:
        """The model's second derivatives along each control at the iterate, shape (3 N,)."""
        return np.diagonal(self._condensed.hessian) + self._prices[self._active] @ self._active_slopes**2

    def step(
        self, controls: Vector, inputs: InputParameters, solver: QpSolver, guess: Multipliers | None, hard: Mask
    ) -> Step:
        """Minimises the model over the input set.

        Args:
            controls: the iterate, shape (N, 3).
            inputs: p^a.
            solver: of the quadratic programs.
            guess: multipliers near those to be found; from the iterate itself if None.
            hard: stages and obstacle slots whose margin is constrained to be >= 0, shape (N, M).
        """
        lin = self._lin
        lower, upper = ((bound - controls).ravel() for bound in (inputs.lower, inputs.upper))
        guess = guess or self._first_guess(lower, upper, hard)
        walls = self._row_slopes(hard)
        margins = lin.widths[0] - lin.excesses[:, : hard.shape[1]][hard]
        chosen, slopes = self._near.copy(), self._near_slopes
        for passes_left in reversed(range(_PASSES)):
            problem = SoftBoxQp(
                hessian=self._condensed.hessian,
                transform=self._condensed.transform,
                gradient=self._gradient,
                lower=lower,
                upper=upper,
                rows=np.concatenate((slopes, walls)),
                bounds=np.concatenate((-lin.excesses[chosen], margins)),
                prices=np.concatenate((self._prices[chosen], np.full(len(margins), np.inf))),
            )
            found = solver.solve(problem, np.concatenate((guess.box, guess.rows[chosen], guess.hard[hard])))
            forgotten = self._priced & ~chosen & (self._excesses_after(found.point) > 0)
            if not passes_left or not forgotten.any():
                break
            chosen |= forgotten
            slopes = self._row_slopes(chosen)
        rows, clearance = np.zeros_like(lin.excesses), np.zeros(hard.shape)
        rows[chosen], clearance[hard] = np.split(found.row_duals, [len(found.row_duals) - len(margins)])
        before = 0.5 * self._prices[chosen] @ np.maximum(lin.excesses[chosen], 0.0) ** 2
        return Step(
            found.status,
            direction=found.point.reshape(controls.shape),
            decrease=problem.objective(found.point) - float(before),
            multipliers=Multipliers(found.box_duals, rows, clearance),
            wall_force=(clearance[hard] @ walls).reshape(controls.shape),
        )

    def _first_guess(self, lower: Vector, upper: Vector, hard: Mask) -> Multipliers:
        """What touches a bound or is exceeded at the iterate is taken for active."""
        at_bound = (upper <= AT_BOUND).astype(float) - (lower >= -AT_BOUND)
        return Multipliers(at_bound, np.maximum(self._lin.excesses, 0.0), np.zeros(hard.shape))

    def _row_slopes(self, chosen: Mask) -> Vector:
        """Slopes of the chosen excesses by U, shape (number chosen, 3 N); `chosen` may cover the first rows only."""
        stages, rows = np.nonzero(chosen)
        slopes = self._lin.slopes[stages, rows]
        return np.matmul(slopes[:, None, :], self._condensed.sensitivities[stages])[:, 0, :]

    def _excesses_after(self, step: Vector) -> Vector:
        deviations = self._condensed.sensitivities @ step
        return self._lin.excesses + np.matmul(self._lin.slopes, deviations[:, :, None])[:, :, 0]


def _reverse_braking(linearisation: Linearisation, sensitivities: Vector) -> Vector:
    """What the reverse-braking penalty adds to the Hessian: a share of its positive part.

    The penalty is a product, brake times backward speed, so its Hessian [[0, c], [c, d]] is indefinite, and without it
    the two zigzag. With the positive eigenvalue p and its eigenvector (c, p), the positive part is
    p (c, p) (c, p)' / (c^2 + p^2). All of it is too cautious: a quarter needs the fewest iterations.
    """
    lin = linearisation
    stages = np.flatnonzero(lin.couplings > 0)
    c = lin.couplings[stages]
    d = np.where(lin.excesses[stages, -1] < lin.widths[-1], lin.prices[stages, -1] / lin.widths[-1], 0.0)
    p = d / 2 + np.sqrt(d * d / 4 + c * c)
    rows = -p[:, None] * sensitivities[stages, StateIndex.FORWARD_VELOCITY]
    rows[np.arange(len(stages)), CONTROL_SIZE * stages + ControlIndex.BRAKE] += c
    return rows.T @ (rows * (_CAUTION * p / (c * c + p * p))[:, None])
