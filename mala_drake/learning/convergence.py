"""When a preference learner counts as converged (paper, Sec. "Simulation Results": d <= 0.15)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

CONVERGED_DISTANCE = 0.15


def preference_distance(weights: npt.ArrayLike, true_weights: npt.ArrayLike) -> float:
    """The distance d = ||w - w*||_2."""
    return float(np.linalg.norm(np.asarray(weights, dtype=float) - np.asarray(true_weights, dtype=float)))


def convergence_episode(distances: Iterable[float], *, threshold: float = CONVERGED_DISTANCE) -> int | None:
    """The number of rated episodes after which d <= threshold first holds, or None if it never does.

    Args:
        distances: d after the first rated episode, after the second, and so on. (The paper counts from 0: its
            figures are smaller by one.)
        threshold: of convergence.
    """
    return next((number for number, distance in enumerate(distances, start=1) if distance <= threshold), None)
