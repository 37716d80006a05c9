"""How the KKT system changes with the parameters: d kappa / d p of the paper's eq. (IFT), stage by stage.

The terms are sparse (a reference enters one stage, an obstacle only where it is near), so each stage gives the values
of a fixed pattern. The dynamics group is dense and kept apart, as it alone also moves the predicted states.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import casadi
import numpy as np
from numpy.typing import NDArray

from mala_drake.buffered_function import BufferedFunction, densified
from mala_drake.control.model import CONTROL_SIZE, DYNAMICS_SIZE, STATE_SIZE

from .kkt_point import KktPoint
from .stage_functions import StageFunctions

Vector = NDArray[np.float64]

_ROWS = STATE_SIZE + CONTROL_SIZE


@dataclass(frozen=True, slots=True)
class NodeTerms:
    """d (gradient of a stage's cost with respect to (z_{k+1}, u_k)) / d p, by its entries.

    Stage k has the entry values[k, i] in row rows[i] (0 ... 5 for z_{k+1}, 6 ... 8 for u_k) and column columns[k, i].
    """

    values: Vector  # Shape (N, n).
    rows: NDArray[np.intp]  # Shape (n,).
    columns: NDArray[np.intp]  # Shape (N, n).


@dataclass(frozen=True, slots=True)
class DynamicsTerms:
    """How p^f enters: d f / d p^f and d (gradient of lambda' f with respect to (z_k, u_k)) / d p^f."""

    offset: Vector  # Shape (N, 6, 6).
    mixed: Vector  # Shape (N, 9, 6).


class ParameterTerms:
    """Evaluates the terms of one problem at a point. Owns work arrays; functions are created at first use."""

    def __init__(self, functions: StageFunctions) -> None:
        self._functions = functions

    def nodes(self, point: KktPoint, groups: Collection[str]) -> list[NodeTerms]:
        """The terms of p^w and p^g (which are one function), and of p^h, where requested."""
        terms = []
        if {"terminal", "stage"} & set(groups):
            terms.append(self._tracking(point))
        if "constraints" in groups:
            terms.append(self._penalties(point))
        return terms

    def dynamics(self, point: KktPoint) -> DynamicsTerms:
        """The terms of p^f."""
        function, horizon = self._dynamics_function, self._functions.horizon
        packed = point.packed[self._functions.data.sources]
        for argument, rows in zip(
            function.arguments, (point.states[:-1], point.controls, point.costates[1:], packed), strict=True
        ):
            argument[:] = rows.T
        function()
        offset, mixed = (result.T.copy() for result in function.results)
        return DynamicsTerms(
            offset.reshape(horizon, STATE_SIZE, DYNAMICS_SIZE), mixed.reshape(horizon, _ROWS, DYNAMICS_SIZE)
        )

    @cached_property
    def _tracking(self) -> _NodeFunction:
        return _NodeFunction(self._functions, self._functions.tracking + self._functions.effort)

    @cached_property
    def _penalties(self) -> _NodeFunction:
        return _NodeFunction(self._functions, self._functions.penalties)

    @cached_property
    def _dynamics_function(self) -> BufferedFunction:
        f = self._functions
        dynamics = f.data.pieces(f.numbers)["dynamics"]
        both = casadi.vertcat(f.state, f.control)
        gradient = casadi.gradient(casadi.dot(f.costate, f.next_state), both)
        outputs = [casadi.jacobian(f.next_state, dynamics).T, casadi.jacobian(gradient, dynamics).T]
        inputs = [f.state, f.control, f.costate, f.numbers]
        return BufferedFunction(densified("dynamics_terms", inputs, outputs).map(f.horizon))


class _NodeFunction:
    """The mixed second derivative of one part of a node's cost, as values of a fixed sparsity pattern."""

    def __init__(self, functions: StageFunctions, cost: casadi.SX) -> None:
        self._sources = functions.data.sources
        both = casadi.vertcat(functions.reached, functions.control)
        mixed = casadi.jacobian(casadi.gradient(cost, both), functions.numbers)
        rows, columns = mixed.sparsity().get_triplet()
        self._rows, columns = np.array(rows, dtype=np.intp), np.array(columns, dtype=np.intp)
        self._columns = self._sources[:, columns]
        values = casadi.vertcat(*mixed.nonzeros())
        stage = densified("node_terms", [functions.reached, functions.control, functions.numbers], [values])
        self._function = BufferedFunction(stage.map(functions.horizon))

    def __call__(self, point: KktPoint) -> NodeTerms:
        for argument, rows in zip(
            self._function.arguments, (point.states[1:], point.controls, point.packed[self._sources]), strict=True
        ):
            argument[:] = rows.T
        self._function()
        return NodeTerms(self._function.results[0].T.copy(), self._rows, self._columns)
