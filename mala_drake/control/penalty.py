"""The smoothed exact penalty by which path constraints enter the single-shooting cost.

A constraint margin >= 0 is replaced by the cost rho * phi(buffer - margin), where phi is the Huberised hinge. It is the
l1 penalty of Nocedal and Wright, Numerical Optimization (2nd ed.), Sec. 17.2, made continuously differentiable: zero
up to the buffer, quadratic within it, of slope one past the constraint. An l1 penalty is exact once rho exceeds the
constraint's multiplier; this one is then feasible too, because the quadratic piece lies on the safe side of the
constraint and already reaches slope rho where margin = 0. The multiplier is rho * phi'(buffer - margin).
"""

from __future__ import annotations

from typing import Any

import casadi


def huberised_hinge(excess: Any, width: float) -> Any:
    """phi: 0 for excess <= 0, excess^2 / (2 width) up to `width`, excess - width / 2 beyond.

    Written without branches: with s = min(max(excess, 0), width) it is s (excess - s / 2) / width.
    """
    clipped = casadi.fmin(casadi.fmax(excess, 0), width)
    return clipped * (excess - clipped / 2) / width


def hinge_slope(excess: Any, width: float) -> Any:
    """phi', between 0 and 1: the share of the penalty's slope that is in use."""
    return casadi.fmin(casadi.fmax(excess, 0), width) / width
