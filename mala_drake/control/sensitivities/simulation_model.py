"""f*: the model over which a closed loop is differentiated, that of the MPC with a learned residual.

z_{i+1} = f(z_i, u_i; p^f) + Phi(z_i, u_i) c, with features Phi that are any smooth function and learned coefficients c.
Gradients through the contact physics would be wrong; the physics supplies the data that c is learned from.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi
import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.buffered_function import BufferedFunction, densified
from mala_drake.clock import TICK
from mala_drake.control import model
from mala_drake.errors import BadInput
from mala_drake.messages import Message

Vector = NDArray[np.float64]
Features = Callable[[casadi.SX, casadi.SX], casadi.SX]
"""(z, u) -> Phi, shape (6, m), in CasADi operations."""


@dataclass(frozen=True, slots=True, eq=False)
class Transition(Message):
    """One step of f* with its exact first derivatives."""

    state: Vector  # The next state, shape (6,).
    by_state: Vector  # Shape (6, 6).
    by_control: Vector  # Shape (6, 3).
    by_parameters: Vector  # With respect to (p^f, c), shape (6, 6 + m).


class SimulationModel:
    """f*(z, u; p^f, c). Owns work arrays."""

    def __init__(self, features: Features | None = None, *, period: float = TICK) -> None:
        """States the model.

        Args:
            features: of the residual; none if left out.
            period: seconds of one step.

        Raises:
            BadInput: the features do not have a row for each state.
        """
        state, control = casadi.SX.sym("state", model.STATE_SIZE), casadi.SX.sym("control", model.CONTROL_SIZE)
        basis = features(state, control) if features is not None else casadi.SX(model.STATE_SIZE, 0)
        if basis.shape[0] != model.STATE_SIZE:
            raise BadInput("SimulationModel.features", f"{basis.shape[0]} rows", f"{model.STATE_SIZE}, one a state")
        self.parameter_size = model.DYNAMICS_SIZE + basis.shape[1]
        parameters = casadi.SX.sym("parameters", self.parameter_size)
        dynamics, coefficients = parameters[: model.DYNAMICS_SIZE], parameters[model.DYNAMICS_SIZE :]
        reached = model.step(state, control, dynamics, period) + basis @ coefficients
        jacobians = [casadi.jacobian(reached, symbol) for symbol in (state, control, parameters)]
        self._function = BufferedFunction(densified("f_star", [state, control, parameters], [reached, *jacobians]))

    def step(self, state: ArrayLike, control: ArrayLike, parameters: ArrayLike) -> Transition:
        """One step from `state`, shape (6,), under `control`, shape (3,), with (p^f, c), shape (6 + m,)."""
        for argument, value in zip(self._function.arguments, (state, control, parameters), strict=True):
            argument[:, 0] = value
        self._function()
        reached, by_state, by_control, by_parameters = (result.copy() for result in self._function.results)
        return Transition(reached[:, 0], by_state, by_control, by_parameters)
