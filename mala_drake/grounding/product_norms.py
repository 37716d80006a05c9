"""Product and probabilistic sum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mala_drake.grounding.norms import AbstractNorms, FloatArray


@dataclass(frozen=True, slots=True)
class ProductNorms(AbstractNorms):
    """T(a, b) = a b, S(a, b) = a + b - a b: smooth, and sensitive to every degree."""

    def conjunction(self, values: npt.ArrayLike) -> FloatArray:
        """The product of the degrees."""
        return np.prod(np.asarray(values, dtype=float), axis=-1)

    def disjunction(self, values: npt.ArrayLike) -> FloatArray:
        """The probability that at least one of independent events with these probabilities happens."""
        return 1.0 - np.prod(1.0 - np.asarray(values, dtype=float), axis=-1)

    def conjunction_gradient(self, values: npt.ArrayLike) -> FloatArray:
        """The product of all the other degrees."""
        degrees = np.asarray(values, dtype=float)
        ones = np.ones_like(degrees[..., :1])
        # Products before and after each entry: dividing the whole product by the entry fails at 0.
        before = np.cumprod(np.concatenate([ones, degrees[..., :-1]], axis=-1), axis=-1)
        after = np.cumprod(np.concatenate([ones, degrees[..., :0:-1]], axis=-1), axis=-1)[..., ::-1]
        return (before * after)[..., : degrees.shape[-1]]
