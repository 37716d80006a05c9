"""How the end of a leg moves with its target, as far as targets are learned through it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mala_drake.learning.abstract_learner import FloatArray
from mala_drake.messages import SensitivitySource

_MOST_UNLIKE = 0.5  # Of a sensitivity from the identity, by its greatest singular value.


@dataclass(frozen=True, slots=True, eq=False)
class EndSensitivity:
    """The sensitivity S that an update goes through.

    Attributes:
        matrix: S = d reached position / d target, (2, 2).
        source: where it is from.
        deviation: |S - I|_2 of what was simulated, whether it is `matrix` or not; None where nothing was, or in vain.
    """

    matrix: FloatArray
    source: SensitivitySource
    deviation: float | None = None


def by_identity(source: SensitivitySource, deviation: float | None = None) -> EndSensitivity:
    """An end that moves as its target does."""
    return EndSensitivity(np.eye(2), source, deviation)


def plausible_sensitivity(simulated: FloatArray | None) -> EndSensitivity:
    """The sensitivity of a leg that has stopped at its target, or the identity where it cannot be so.

    A leg that has stopped is within the tolerance of its target, wherever that is: over a step many times as long, the
    sensitivity is the identity in the mean. Its derivative at one point may be far from that, or not exist (None): of a
    leg that was over at once, or whose last steps bend because of a limit. Then the mean is the better guess.
    """
    if simulated is None or not np.isfinite(simulated).all():
        return by_identity(SensitivitySource.FALLBACK)
    deviation = float(np.linalg.norm(simulated - np.eye(2), 2))
    if deviation > _MOST_UNLIKE:
        return by_identity(SensitivitySource.FALLBACK, deviation)
    return EndSensitivity(simulated, SensitivitySource.SIMULATED, deviation)
