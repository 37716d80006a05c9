"""Minimum and maximum (Zadeh, Goedel)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.grounding.norms import AbstractNorms, FloatArray


@dataclass(frozen=True, slots=True)
class MinimumNorms(AbstractNorms):
    """T = min, S = max: the largest t-norm and the smallest t-conorm, the only idempotent ones."""

    def conjunction(self, values: npt.ArrayLike) -> FloatArray:
        """The smallest degree."""
        return np.min(np.asarray(values, dtype=float), axis=-1, initial=1.0)

    def disjunction(self, values: npt.ArrayLike) -> FloatArray:
        """The largest degree."""
        return np.max(np.asarray(values, dtype=float), axis=-1, initial=0.0)

    def conjunction_gradient(self, values: npt.ArrayLike) -> FloatArray:
        """1 for the smallest degree (the first of equals), 0 for the others."""
        degrees = np.asarray(values, dtype=float)
        if degrees.shape[-1] == 0:
            return np.zeros_like(degrees)
        smallest = np.argmin(degrees, axis=-1, keepdims=True)
        return (np.arange(degrees.shape[-1]) == smallest).astype(float)
