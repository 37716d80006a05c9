"""How good a point is, measured the same way whoever found it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .parameters import InputParameters, MpcParameters
from .solution import Status

Vector = NDArray[np.float64]

SOLVED = 10.0
"""A point within this many tolerances is optimal, whatever the solver thinks of its line search."""

INACCURATE = 100.0
"""A point within this many tolerances is a local optimum to working accuracy."""


def cost_scale(parameters: MpcParameters) -> float:
    """The factor on the cost in which tolerances are meant: the largest weight sets the size of the cost."""
    return 1.0 / max(parameters.terminal.weights.max(), parameters.stage.state_weights.max(), 1.0)


def residual(controls: Vector, gradient: Vector, curvature: Vector, inputs: InputParameters) -> float:
    """The KKT residual: the largest component of the gradient projected on the box, over its Hessian's diagonal root.

    With `gradient` and `curvature`, 3 N entries each, those of the scaled cost, it is the residual in variables of unit
    curvature. Zero exactly at a KKT point.
    """
    gradient, curvature = gradient.reshape(controls.shape), curvature.reshape(controls.shape)
    step = np.clip(controls - gradient / curvature, inputs.lower, inputs.upper) - controls
    return float((np.abs(step) * np.sqrt(curvature)).max())


def status_of(residual: float, tolerance: float, stopped: Status) -> Status:
    """The status of a point by its residual.

    Args:
        residual: see above.
        tolerance: what was asked for.
        stopped: why the solver stopped. One stopped for its iteration limit has to be optimal to count as solved, one
            that saw no further progress may be inaccurate.
    """
    if residual <= SOLVED * tolerance:
        return Status.SOLVED
    close = residual <= INACCURATE * tolerance and stopped is not Status.ITERATION_LIMIT
    return Status.INACCURATE if close else stopped
