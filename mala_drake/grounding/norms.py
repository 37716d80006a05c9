"""The contract of fuzzy logic: a t-norm for "and", its t-conorm for "or"."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


class AbstractNorms(ABC):
    """A t-norm T, its dual t-conorm S(a) = 1 - T(1 - a), and their gradients (paper, Sec. "Fuzzy Logic").

    Every operation takes degrees of truth (..., n) in [0, 1] and joins them along the last axis. T of nothing is 1
    and S of nothing is 0. Where a norm has a kink, the gradient is one of its subgradients or supergradients.
    """

    __slots__ = ()

    @abstractmethod
    def conjunction(self, values: npt.ArrayLike) -> FloatArray:
        """T(a_1, ..., a_n): (...)."""

    @abstractmethod
    def disjunction(self, values: npt.ArrayLike) -> FloatArray:
        """S(a_1, ..., a_n): (...)."""

    @abstractmethod
    def conjunction_gradient(self, values: npt.ArrayLike) -> FloatArray:
        """The derivatives of T with respect to each a_i: (..., n)."""

    def disjunction_gradient(self, values: npt.ArrayLike) -> FloatArray:
        """The derivatives of S with respect to each a_i: (..., n)."""
        # By duality S(a) = 1 - T(1 - a), and both minus signs cancel.
        return self.conjunction_gradient(1.0 - np.asarray(values, dtype=float))


def negation(value: npt.ArrayLike) -> FloatArray:
    """The standard negation 1 - a."""
    return 1.0 - np.asarray(value, dtype=float)
