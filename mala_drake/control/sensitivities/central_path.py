"""Newton's method on the primal-dual barrier system of the input set.

States and costates follow the controls exactly, so that only stationarity and complementarity have a residual. A step
has the right curvature (that of Gauss and Newton's model where the exact Hessian has not) and decreases the barrier
function (Nocedal & Wright, Numerical Optimization, 2nd ed., Ch. 19). The full step is tried first, put back on the
curve slack * multiplier = nu by the smoothing of Chen, Harker, Kanzow and Smale: it changes many active bounds at once,
where the step that stops short of the first bound needs dozens.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mala_drake.messages import Message

from .sweeps import Factorisation, Sweeps

Vector = NDArray[np.float64]

_RESIDUAL = 2e-11  # In variables of unit curvature, relative to the root of the cost; rounding leaves a tenth of it.
_COMPLEMENTARITY = 1e-6  # Relative to nu.
_TO_BOUNDARY = 0.995  # Share of the way to a bound that one step may take.
_SUFFICIENT = 1e-4  # Of the decrease that the slope promises.
_HALVINGS = 30
_ROUNDING = 1e-12  # Relative to the cost; a promised decrease below it cannot be seen.
_LARGEST_SLACK = 0.9  # Share of the box.


@dataclass(frozen=True, slots=True, eq=False)
class PathPoint(Message):
    """Where a search ended."""

    controls: Vector  # Shape (N, 3), and the multipliers too.
    lower_multipliers: Vector
    upper_multipliers: Vector
    states: Vector  # Shape (N + 1, 6).
    factorisation: Factorisation
    converged: bool
    iterations: int
    residual: float


@dataclass(frozen=True, slots=True)
class _Iterate:
    controls: Vector
    lower: Vector  # Multipliers.
    upper: Vector
    states: Vector
    merit: float  # The barrier function.


class CentralPathSearch:
    """The search for one initial state and parameter vector, which are those of `sweeps`."""

    def __init__(self, sweeps: Sweeps, lower: Vector, upper: Vector, least_curvature: Vector) -> None:
        """Prepares a search.

        Args:
            sweeps: evaluates the problem.
            lower: bounds, shape (N, 3); where they are equal to the upper ones, the control is no variable.
            upper: bounds.
            least_curvature: a positive lower estimate of the cost's curvature by control, shape (3,).
        """
        self._sweeps = sweeps
        self._lower, self._upper = lower, upper
        self._free = lower < upper
        self._mask = self._free.astype(float)
        self._least = np.broadcast_to(least_curvature, lower.shape)
        self._rounding = 4 * np.finfo(float).eps * np.maximum(np.abs(lower), np.abs(upper))
        # Controls that are no variables have slacks of one, so that nothing divides by zero and no logarithm counts.
        self._width = np.where(self._free, upper - lower, 1.0)

    def run(self, start: Vector, duals: Vector, barrier: float, limit: int) -> PathPoint:
        """Searches for at most `limit` Newton steps.

        Args:
            start: controls, shape (N, 3).
            duals: multipliers, positive at lower and negative at upper bounds, shape (N, 3).
            barrier: nu.
            limit: of iterations.
        """
        iterate = self._first(start, duals, barrier)
        for iteration in range(limit + 1):
            below, above = self._slacks(iterate.controls)
            slope = self._mask * (barrier / above - barrier / below)
            curvature = iterate.lower / below + iterate.upper / above
            factorisation = self._factorise(iterate, curvature, slope)
            scale = np.maximum(factorisation.curvature, self._least)
            missing = factorisation.gradient - slope - iterate.lower + iterate.upper
            residual = float(np.abs(self._mask * missing / np.sqrt(scale)).max())
            # A residual that is not finite compares as not converged.
            tolerance = _RESIDUAL * float(np.sqrt(1.0 + abs(iterate.merit)))
            converged = residual <= tolerance and self._is_complementary(iterate, below, above, barrier)
            if converged or iteration == limit or not np.isfinite(residual):
                break
            if not factorisation.pivots.min() > 0:
                factorisation = self._factorise(iterate, curvature, slope, convex=True)
            improved = self._step(iterate, factorisation, scale, barrier)
            if improved is None:
                break
            iterate = improved
        return PathPoint(
            controls=iterate.controls,
            lower_multipliers=iterate.lower,
            upper_multipliers=iterate.upper,
            states=iterate.states,
            factorisation=factorisation,
            converged=converged,
            iterations=iteration,
            residual=residual,
        )

    def _first(self, start: Vector, duals: Vector, barrier: float) -> _Iterate:
        """The start with multipliers of the bounds that it is at; elsewhere a dual is an error."""
        below, above = self._slacks(start)
        down, up = np.maximum(duals, 0.0), np.maximum(-duals, 0.0)
        at_lower, at_upper = (down > self._least * below).astype(float), (up > self._least * above).astype(float)
        return self._centred(start, at_lower * down, at_upper * up, self._least, barrier)

    def _step(self, iterate: _Iterate, factorisation: Factorisation, scale: Vector, barrier: float) -> _Iterate | None:
        """The next iterate, or None where no step decreases the barrier function."""
        below, above = self._slacks(iterate.controls)
        step = self._sweeps.newton_step(factorisation)
        lower_step = self._mask * (barrier / below - iterate.lower / below * step) - iterate.lower
        upper_step = self._mask * (barrier / above + iterate.upper / above * step) - iterate.upper
        promised = float((factorisation.gradient * step).sum())
        highest = iterate.merit + _ROUNDING * (1.0 + abs(iterate.merit))
        # A multiplier that turns negative releases its bound, and what the control does then is in the step.
        lower, upper = np.maximum(iterate.lower + lower_step, 0.0), np.maximum(iterate.upper + upper_step, 0.0)
        centred = self._centred(iterate.controls + step, lower, upper, scale, barrier)
        if centred.merit <= highest + _SUFFICIENT * promised:
            return centred
        dual_length = min(_length(iterate.lower, lower_step), _length(iterate.upper, upper_step))
        lower, upper = iterate.lower + dual_length * lower_step, iterate.upper + dual_length * upper_step
        length = min(_length(below, step), _length(above, -step))
        for _ in range(_HALVINGS):
            trial = self._evaluated(iterate.controls + length * step, lower, upper, barrier)
            if trial.merit <= highest + _SUFFICIENT * length * promised:
                return trial
            length /= 2
        return None

    def _centred(self, controls: Vector, lower: Vector, upper: Vector, scale: Vector, barrier: float) -> _Iterate:
        """The iterate with slack * multiplier = nu nearest to controls and multipliers that need not have it.

        Of each control's bounds the one that presses it more, or is nearer, counts. Its slack s and multiplier mu solve
        s mu = nu and scale s - mu = t, where t is that difference of what is given.
        """
        pressed = controls - (lower - upper) / scale
        near_lower = pressed - self._lower <= self._upper - pressed
        offset = np.where(
            near_lower, scale * (controls - self._lower) - lower, scale * (self._upper - controls) - upper
        )
        product = 4 * scale * barrier
        root = np.sqrt(offset * offset + product)
        # For negative offsets the sum cancels: there its conjugate is used.
        positive = np.maximum(offset, 0.0)
        slack = np.where(offset > 0, positive + root, product / (root - np.minimum(offset, 0.0))) / (2 * scale)
        slack = np.minimum(slack, _LARGEST_SLACK * self._width)
        inside = np.where(near_lower, self._lower + slack, self._upper - slack)
        controls = np.where(self._free, inside, self._lower)
        # From the slack itself: once added to its bound it has lost the digits that a large multiplier needs.
        multiplier, other = self._mask * barrier / slack, self._mask * barrier / (self._width - slack)
        lower, upper = np.where(near_lower, multiplier, other), np.where(near_lower, other, multiplier)
        return self._evaluated(controls, lower, upper, barrier)

    def _evaluated(self, controls: Vector, lower: Vector, upper: Vector, barrier: float) -> _Iterate:
        states, cost = self._sweeps.forward(controls)
        below, above = self._slacks(controls)
        return _Iterate(controls, lower, upper, states, cost - barrier * float(np.log(below * above).sum()))

    def _is_complementary(self, iterate: _Iterate, below: Vector, above: Vector, barrier: float) -> bool:
        """Whether all slacks times multipliers are nu, but for what is lost by adding slack and bound."""
        largest = np.maximum(iterate.lower, iterate.upper)
        gaps = np.maximum(np.abs(iterate.lower * below - barrier), np.abs(iterate.upper * above - barrier))
        return bool((self._mask * gaps <= _COMPLEMENTARITY * barrier + self._rounding * largest).all())

    def _slacks(self, controls: Vector) -> tuple[Vector, Vector]:
        """Distances to the bounds; 1 for controls that are no variables."""
        fixed = 1.0 - self._mask
        return self._mask * (controls - self._lower) + fixed, self._mask * (self._upper - controls) + fixed

    def _factorise(self, iterate: _Iterate, curvature: Vector, slope: Vector, *, convex: bool = False) -> Factorisation:
        return self._sweeps.backward(
            iterate.states, iterate.controls, curvature=curvature, slope=slope, free=self._mask, convex=convex
        )


def _length(values: Vector, step: Vector) -> float:
    """The share of the step, at most 1, that keeps positive `values` positive."""
    fastest = float((-step / np.where(values > 0, values, np.inf)).max())
    return min(1.0, _TO_BOUNDARY / fastest) if fastest > 0 else 1.0
