"""The parametric optimal control problem that every MPC solver of the project shares."""

from __future__ import annotations

from functools import cached_property

import casadi
import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.buffered_function import densified
from mala_drake.clock import TICK
from mala_drake.errors import BadInput

from . import model
from .layout import ParameterLayout
from .parameters import MpcParameters
from .shooting import ShootingExpressions, build_expressions

Vector = NDArray[np.float64]


class OptimalControlProblem:
    """The finite-horizon problem of the paper, eq. (MPCinner), in the controls alone (single shooting).

    minimise   V_N(z_N; p^w) + sum_k L(z_k, u_k; p^g) + penalties(z_k; p^h)   over U = (u_0 ... u_{N-1})
    subject to z_{k+1} = f(z_k, u_k; p^f), z_0 given, u_k in A(p^a)

    Path constraints enter as smoothed exact penalties (`penalty.py`), so that the problem is feasible from every state.
    The problem depends on its parameters p only through their values: it is built once and solved for any action.
    CasADi functions are created at first use, in well under a second, and nothing is compiled.
    """

    def __init__(self, *, horizon: int = 20, period: float = TICK, obstacle_slots: int = 8) -> None:
        """States the problem.

        Args:
            horizon: the number of stages N.
            period: the control period h, seconds.
            obstacle_slots: how many obstacles can count at once.

        Raises:
            BadInput: a size is not a positive number.
        """
        for name, value in (("horizon", horizon), ("period", period), ("obstacle_slots", obstacle_slots)):
            if not value > 0:
                raise BadInput(f"OptimalControlProblem.{name}", str(value), "a positive number")
        self.horizon = horizon
        self.period = period
        self.layout = ParameterLayout(horizon, obstacle_slots)
        self._others: dict[int, OptimalControlProblem] = {}

    def of_horizon(self, horizon: int) -> OptimalControlProblem:
        """The same problem with another number of stages: itself, or one that is made at its first use and kept.

        Raises:
            BadInput: the number is not positive.
        """
        if horizon == self.horizon:
            return self
        if horizon not in self._others:
            self._others[horizon] = type(self)(horizon=horizon, period=self.period, obstacle_slots=self.layout.slots)
        return self._others[horizon]

    @cached_property
    def expressions(self) -> ShootingExpressions:
        """The symbolic problem, for whoever needs a derivative of it that is not here."""
        return build_expressions(self.layout, self.period)

    @cached_property
    def cost(self) -> casadi.Function:
        """(U, z_0, p) -> cost."""
        return densified("cost", self._inputs, [self.expressions.cost])

    @cached_property
    def cost_and_gradient(self) -> casadi.Function:
        """(U, z_0, p) -> (cost, d cost / d U); U and the gradient have shape (3, N)."""
        problem = self.expressions
        outputs = [problem.cost, casadi.gradient(problem.cost, problem.controls)]
        return densified("cost_and_gradient", self._inputs, outputs)

    @cached_property
    def hessian(self) -> casadi.Function:
        """(U, z_0, p) -> second derivative of the cost with respect to vec(U), shape (3 N, 3 N)."""
        problem = self.expressions
        return densified("hessian", self._inputs, [casadi.hessian(problem.cost, casadi.vec(problem.controls))[0]])

    @cached_property
    def trajectory(self) -> casadi.Function:
        """(U, z_0, p) -> (states, obstacle margins, limit margins, obstacle multipliers, limit multipliers).

        Shapes (6, N + 1), (M, N), (6, N), (M, N), (6, N); see `ShootingExpressions`.
        """
        e = self.expressions
        outputs = [e.states, e.obstacle_margins, e.limit_margins, e.obstacle_multipliers, e.limit_multipliers]
        return densified("trajectory", self._inputs, outputs)

    @cached_property
    def step(self) -> casadi.Function:
        """(z, u, p^f) -> z_next over one control period."""
        return model.step_function(self.period)

    @cached_property
    def stage(self) -> casadi.Function:
        """(z, u, p^f) -> (z_next, d z_next / d z, d z_next / d u) over one control period."""
        state, control = casadi.SX.sym("state", model.STATE_SIZE), casadi.SX.sym("control", model.CONTROL_SIZE)
        dynamics = casadi.SX.sym("dynamics", model.DYNAMICS_SIZE)
        next_state = model.step(state, control, dynamics, self.period)
        outputs = [next_state, casadi.jacobian(next_state, state), casadi.jacobian(next_state, control)]
        return densified("stage", [state, control, dynamics], outputs)

    @cached_property
    def stage_jacobians(self) -> casadi.Function:
        """(Z, U, p^f) -> (A, B): all stages' d z_next / d z, shape (6, 6 N), and d z_next / d u, shape (6, 3 N)."""
        state, control = casadi.SX.sym("state", model.STATE_SIZE), casadi.SX.sym("control", model.CONTROL_SIZE)
        dynamics = casadi.SX.sym("dynamics", model.DYNAMICS_SIZE)
        one_stage = densified("jacobians", [state, control, dynamics], self.stage(state, control, dynamics)[1:])
        return one_stage.map("stage_jacobians", "serial", self.horizon, [2], [])

    def rollout(self, initial_state: ArrayLike, controls: ArrayLike, parameters: MpcParameters) -> Vector:
        """The predicted states, shape (N + 1, 6), under `controls`, shape (N, 3), from `initial_state`, shape (6,)."""
        states = [np.asarray(initial_state, dtype=float)]
        dynamics = parameters.dynamics.vector
        for control in np.asarray(controls, dtype=float):
            states.append(self.step(states[-1], control, dynamics).full()[:, 0])
        return np.array(states)

    def pack(self, initial_state: Vector, parameters: MpcParameters) -> Vector:
        """The parameter vector p of `layout` for a solve from `initial_state`.

        Raises:
            BadInput: the parameters describe another horizon.
        """
        if parameters.horizon != self.horizon:
            raise BadInput("MpcParameters", f"{parameters.horizon} stages", f"the problem's horizon, {self.horizon}")
        return self.layout.pack(initial_state, parameters)

    @property
    def _inputs(self) -> list[casadi.SX]:
        return [self.expressions.controls, self.expressions.initial_state, self.expressions.parameters]
