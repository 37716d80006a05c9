"""The norms of Lukasiewicz logic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.grounding.norms import AbstractNorms, FloatArray


@dataclass(frozen=True, slots=True)
class LukasiewiczNorms(AbstractNorms):
    """T(a, b) = max(0, a + b - 1), S(a, b) = min(1, a + b): strict, so that many half-truths make no truth."""

    def conjunction(self, values: npt.ArrayLike) -> FloatArray:
        """1 minus the sum of what each degree lacks, but not below 0."""
        return np.maximum(0.0, 1.0 - np.sum(1.0 - np.asarray(values, dtype=float), axis=-1))

    def disjunction(self, values: npt.ArrayLike) -> FloatArray:
        """The sum of the degrees, but not above 1."""
        return np.minimum(1.0, np.sum(np.asarray(values, dtype=float), axis=-1))

    def conjunction_gradient(self, values: npt.ArrayLike) -> FloatArray:
        """1 for every degree while the conjunction is positive, 0 once it is not."""
        degrees = np.asarray(values, dtype=float)
        positive = np.sum(1.0 - degrees, axis=-1, keepdims=True) < 1.0
        return np.where(positive, np.ones_like(degrees), 0.0)
