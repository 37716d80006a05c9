"""From a step to the next iterate: a backtracking line search on the cost itself.

The cost is its own merit function, because path constraints are exact penalties in it already (Nocedal & Wright,
Numerical Optimization, 2nd ed., Sec. 18.3). Hard clearance, where it is asked for, adds an l1 term of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

_SUFFICIENT = 1e-4  # Share of the predicted decrease that must be realised (Armijo).
_SHORTEST = 2.0**-12
_ROUND_OFF = 1e-14  # Of the merit, relative: below that a decrease cannot be seen.


@dataclass(frozen=True, slots=True, eq=False)
class Iterate:
    """Controls with what is known about them."""

    controls: Vector  # Shape (N, 3).
    cost: float
    gradient: Vector | None = None  # Of the cost, shape (N, 3), where it has been evaluated.
    violation: float = 0.0  # Metres of hard clearance missing, over all stages.

    @property
    def finite(self) -> bool:
        """Whether the cost, and the gradient if there is one, exist here."""
        known = self.gradient is None or np.isfinite(self.gradient).all()
        return bool(known and np.isfinite(self.cost + self.violation))

    def merit(self, price: float) -> float:
        """Cost and `price` per metre of violation."""
        return self.cost + price * self.violation


def line_search(
    evaluate: Callable[[Vector], Iterate], start: Iterate, direction: Vector, decrease: float, price: float = 0.0
) -> Iterate | None:
    """The first of start + direction, start + direction / 2 ... that decreases the merit enough; None if none does.

    Args:
        evaluate: gives the iterate of some controls.
        start: where to start.
        direction: dU, shape (N, 3); start + direction is inside the input set, which is convex.
        decrease: predicted change of the cost over the whole step, at whose end no violation is predicted.
        price: of the merit.
    """
    before = start.merit(price)
    predicted = decrease - price * start.violation
    share = 1.0
    while share >= _SHORTEST:
        candidate = evaluate(start.controls + share * direction)
        wanted = before + _SUFFICIENT * share * predicted + _ROUND_OFF * abs(before)
        if candidate.finite and candidate.merit(price) <= wanted:
            return candidate
        share /= 2.0
    return None
