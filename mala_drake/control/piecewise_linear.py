"""Linear interpolation between samples at one argument at a time, which numpy's costs ten times as much for."""

from __future__ import annotations

from bisect import bisect_right

from numpy.typing import NDArray


class PiecewiseLinear:
    """The function of one number that `numpy.interp` gives, to the last bit; immutable.

    Beyond the samples it is constant. The samples are kept as plain numbers, so that a call costs little more than its
    search.
    """

    __slots__ = ("_arguments", "_values")

    def __init__(self, arguments: NDArray, values: NDArray) -> None:
        """Takes the samples.

        Args:
            arguments: where the function is known, shape (n,) with n >= 1, finite and increasing.
            values: the function there, shape (n,), finite.
        """
        self._arguments: list[float] = arguments.tolist()
        self._values: list[float] = values.tolist()

    def __call__(self, argument: float) -> float:
        """The value at `argument`, which is finite."""
        arguments, values = self._arguments, self._values
        after = bisect_right(arguments, argument)
        if after == 0:
            return values[0]
        if after == len(arguments):
            return values[-1]
        start, value = arguments[after - 1], values[after - 1]
        if argument == start:
            return value
        slope = (values[after] - value) / (arguments[after] - start)
        return slope * (argument - start) + value
