"""The contract of membership functions: a fuzzy set over the real numbers."""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput

FloatArray = npt.NDArray[np.float64]


class AbstractMembership(ABC):
    """A membership function mu: R -> [0, 1] with its derivative, both vectorised (paper, Sec. "Fuzzy Sets").

    Arguments are finite scalars or arrays of any shape; results have the same shape. A NaN gives a NaN. At a kink the
    derivative is the one towards larger arguments; across a jump it is that of the piece the argument belongs to.
    """

    __slots__ = ()

    @abstractmethod
    def value(self, x: npt.ArrayLike) -> FloatArray:
        """The membership mu(x), in [0, 1]."""

    @abstractmethod
    def derivative(self, x: npt.ArrayLike) -> FloatArray:
        """The derivative d mu / d x."""

    def __call__(self, x: npt.ArrayLike) -> FloatArray:
        """The same as `value`."""
        return self.value(x)


def require_increasing(owner: str, **numbers: float) -> None:
    """Raises BadInput unless the numbers are finite and do not decrease in the order they are given."""
    names = list(numbers)
    for name, number in numbers.items():
        if not math.isfinite(number):
            raise BadInput(f"{owner}.{name}", str(number), "a finite number")
    for lower, upper in itertools.pairwise(names):
        if numbers[lower] > numbers[upper]:
            raise BadInput(f"{owner}.{upper}", str(numbers[upper]), f"at least {lower} = {numbers[lower]}")


def require_positive(owner: str, **numbers: float) -> None:
    """Raises BadInput unless every number is finite and positive."""
    for name, number in numbers.items():
        if not (math.isfinite(number) and number > 0.0):
            raise BadInput(f"{owner}.{name}", str(number), "a finite number > 0")
