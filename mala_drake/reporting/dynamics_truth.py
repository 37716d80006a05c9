"""What the coefficients of the controller's model really were in a folder of results."""

from __future__ import annotations

from functools import lru_cache

from mala_drake.errors import BadInput
from mala_drake.reporting.results import Results
from mala_drake.robot.true_dynamics import TrueDynamics, true_dynamics

_MOST_BOXES = 2  # That the robot carries.


def truths(results: Results, condition: str) -> tuple[TrueDynamics, ...]:
    """Of the robot with nothing, with one and with two boxes; empty where the folder does not tell of the robot."""
    scales = [results.told(condition, "robot", name) for name in ("hidden_truth", "gyroscopic_effect")]
    if not all(isinstance(scale, (int, float)) for scale in scales):
        return ()
    return _truths(*map(float, scales))


@lru_cache(maxsize=8)
def _truths(hidden_truth: float, gyroscopic_effect: float) -> tuple[TrueDynamics, ...]:
    try:
        return tuple(
            true_dynamics(hidden_truth=hidden_truth, gyroscopic_effect=gyroscopic_effect, boxes=boxes)
            for boxes in range(_MOST_BOXES + 1)
        )
    except BadInput:
        return ()


def true_range(truth: tuple[TrueDynamics, ...], name: str) -> tuple[float, float] | None:
    """The least and the greatest value of a coefficient; None for one that has no truth of its own."""
    values = [getattr(each, name) for each in truth if hasattr(each, name)]
    return (min(values), max(values)) if values else None
