"""CasADi functions evaluated in place on numpy buffers, without a conversion per call."""

from __future__ import annotations

import casadi
import numpy as np
from numpy.typing import NDArray


class BufferedFunction:
    """A dense CasADi function with fixed argument and result arrays.

    Write into `arguments[i]`, call, read `results[i]`: an evaluation costs what the expressions cost. The arrays are
    two-dimensional in Fortran order, as CasADi stores matrices, and are overwritten by the next call.
    """

    def __init__(self, function: casadi.Function) -> None:
        self.arguments = tuple(_allocate(function.size_in(i)) for i in range(function.n_in()))
        self.results = tuple(_allocate(function.size_out(i)) for i in range(function.n_out()))
        self._buffer, self._evaluate = function.buffer()
        for i, array in enumerate(self.arguments):
            self._buffer.set_arg(i, array.reshape(-1, order="F").data)
        for i, array in enumerate(self.results):
            self._buffer.set_res(i, array.reshape(-1, order="F").data)

    def __call__(self) -> None:
        """Evaluates the function on the present contents of `arguments`."""
        self._evaluate()


def densified(name: str, inputs: list[casadi.SX], outputs: list[casadi.SX]) -> casadi.Function:
    """A function whose outputs are all dense, as the buffers of `BufferedFunction` need."""
    return casadi.Function(name, inputs, [casadi.densify(output) for output in outputs])


def _allocate(size: tuple[int, int]) -> NDArray[np.float64]:
    return np.zeros(size, order="F")
