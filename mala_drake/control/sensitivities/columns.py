"""What a sensitivity is with respect to: the entries of p, the input set and the initial state, by name and group."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mala_drake.control.layout import ParameterLayout
from mala_drake.control.model import CONTROL_SIZE, STATE_SIZE
from mala_drake.errors import BadInput

GROUPS = ("terminal", "stage", "dynamics", "constraints", "inputs", "initial_state")
"""The five parameter groups p^w, p^g, p^f, p^h, p^a, and z_0."""

LOWER, UPPER, INITIAL_STATE = "inputs.lower", "inputs.upper", "initial_state"


class Columns:
    """The columns of every sensitivity: p in the order of `ParameterLayout`, both bounds of the controls, and z_0.

    Attributes:
        slices: piece name to its columns: the names of `ParameterLayout`, `LOWER`, `UPPER` and `INITIAL_STATE`.
        size: the number of columns.
    """

    def __init__(self, layout: ParameterLayout) -> None:
        self._layout = layout
        self._others: dict[int, Columns] = {}
        start = layout.size
        self.slices = dict(layout.slices)
        for name, size in ((LOWER, CONTROL_SIZE), (UPPER, CONTROL_SIZE), (INITIAL_STATE, STATE_SIZE)):
            self.slices[name] = slice(start, start + size)
            start += size
        self.size = start

    def of_horizon(self, horizon: int) -> Columns:
        """Those of the same problem with another number of stages; made at their first use and kept."""
        if horizon == self._layout.horizon:
            return self
        if horizon not in self._others:
            self._others[horizon] = Columns(replace(self._layout, horizon=horizon))
        return self._others[horizon]

    @cached_property
    def parameters(self) -> slice:
        """The columns of the parameters: all but those of z_0."""
        return slice(0, self.slices[INITIAL_STATE].start)

    def of(self, names: Iterable[str]) -> NDArray[np.intp]:
        """The columns of pieces or groups, in the order given.

        Raises:
            BadInput: there is no piece or group of this name.
        """
        return np.concatenate([self._columns(name) for name in names])

    def groups(self, names: Iterable[str]) -> frozenset[str]:
        """The groups that pieces or groups belong to.

        Raises:
            BadInput: there is no piece or group of this name.
        """
        return frozenset(name.split(".", 1)[0] for name in names if self._columns(name).size)

    def _columns(self, name: str) -> NDArray[np.intp]:
        places = [place for piece, place in self.slices.items() if name in (piece, piece.split(".", 1)[0])]
        if not places:
            raise BadInput("sensitivity", repr(name), f"one of {', '.join(GROUPS)}, or a piece of one")
        return np.concatenate([np.arange(place.start, place.stop) for place in places])
