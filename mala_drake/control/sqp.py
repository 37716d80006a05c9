"""Sequential quadratic programming from one state: iterates until optimal, stuck, or told to stop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .evaluation import Evaluation
from .globalisation import Iterate, line_search
from .linearisation import Lineariser
from .optimal_control_problem import OptimalControlProblem
from .optimality import cost_scale, residual, status_of
from .parameters import InputParameters, MpcParameters
from .qp import QpSolver, QpStatus
from .solution import Solution, Status, read_only
from .step_model import AT_BOUND, Condensed, Multipliers, Step, StepModel

Vector = NDArray[np.float64]
Mask = NDArray[np.bool_]


class SqpTools:
    """What searches share: the functions of the problem, and the settings. One search at a time may use them."""

    def __init__(
        self, problem: OptimalControlProblem, qp_solver: QpSolver, *, tolerance: float, hard_clearance: bool
    ) -> None:
        self.evaluation = Evaluation(problem)
        self.lineariser = Lineariser(problem)
        self.qp_solver = qp_solver
        self.tolerance = tolerance
        self.hard_clearance = hard_clearance
        self.slots = problem.layout.slots


class SqpSearch:
    """The search from one state with one set of parameters.

    Attributes:
        iterate: the best controls so far.
        residual: how far from optimal they are; see `optimality.residual`.
        condensed: of the present model.
        evaluations: of cost and gradient so far.
    """

    def __init__(
        self, tools: SqpTools, state: Vector, packed: Vector, parameters: MpcParameters, iterate: Iterate
    ) -> None:
        """Begins at `iterate` with z_0 and p, for which the tools' evaluation has been set."""
        self._tools, self._state, self._packed, self._parameters = tools, state, packed, parameters
        self._scale = cost_scale(parameters)
        self._gradient = np.full_like(iterate.controls, np.nan)  # Of the Lagrangian, the box left out.
        self.residual = np.nan
        self._wall_price = parameters.constraints.obstacle_penalty
        self._multipliers: Multipliers | None = None
        self._walls: Mask | None = None  # Where hard clearance is a constraint; known once margins are.
        self._wall_force = np.zeros_like(iterate.controls)
        self._stuck = False
        self.evaluations = 1
        self.iterate = iterate

    @property
    def over(self) -> bool:
        """Whether another iteration is of no use."""
        return self._stuck or not self.iterate.finite or self.residual <= self._tools.tolerance

    def linearise(self, condensed: Condensed | None = None) -> None:
        """Makes the model at the present iterate; its condensed part may be that of a trajectory nearby."""
        linearisation = self._tools.lineariser(self._state, self.iterate.controls, self._packed)
        self.condensed = condensed or Condensed(linearisation)
        self._model = StepModel(linearisation, self.condensed)
        if self._walls is None:
            self._walls = self._feasible_walls(linearisation.margins(self._tools.slots))
        self._curvature = self._model.curvature()
        self._assess(self._model.gradient())

    def advance(self) -> None:
        """One iteration with the present model: a quadratic program, and a line search along its solution."""
        step = self._step()
        if step.status is not QpStatus.SOLVED and self._walls is not None and self._walls.any():
            # Hard rows can contradict the inputs once the state is not the predicted one: the penalty remains.
            self._walls = np.zeros_like(self._walls)
            self.iterate = replace(self.iterate, violation=0.0)
            step = self._step()
        if step.status is not QpStatus.SOLVED:
            self._stuck = True
            return
        self._multipliers, self._wall_force = step.multipliers, step.wall_force
        self._wall_price = max(self._wall_price, 2.0 * step.multipliers.hard.max(initial=0.0))
        found = line_search(self._evaluate, self.iterate, step.direction, step.decrease, self._wall_price)
        if found is None:
            self._stuck = True
            return
        self.iterate = found
        assert found.gradient is not None
        self._assess(found.gradient)

    def solution(self) -> Solution:
        """What has been found so far, as solvers return it."""
        iterate, inputs = self.iterate, self._parameters.inputs
        states, margins, _, obstacle_duals, limit_duals = self._tools.evaluation.trajectory(iterate.controls)
        if self._multipliers is not None:
            obstacle_duals = obstacle_duals + self._multipliers.hard
        return Solution(
            status=self._status(),
            controls=read_only(iterate.controls),
            states=read_only(states),
            cost=iterate.cost,
            iterations=self.evaluations,
            control_duals=read_only(_box_duals(iterate.controls, self._gradient, inputs)),
            obstacle_duals=read_only(obstacle_duals),
            limit_duals=read_only(limit_duals),
            obstacle_margins=read_only(margins),
            optimality=self.residual,
        )

    def _status(self) -> Status:
        if not self.iterate.finite:
            return Status.NUMERICAL
        return status_of(
            self.residual, self._tools.tolerance, Status.NUMERICAL if self._stuck else Status.ITERATION_LIMIT
        )

    def _evaluate(self, controls: Vector) -> Iterate:
        self.evaluations += 1
        evaluation, inputs = self._tools.evaluation, self._parameters.inputs
        controls = np.minimum(np.maximum(controls, inputs.lower), inputs.upper)  # Against round-off.
        cost, gradient = evaluation.cost_and_gradient(controls)
        violation = 0.0
        if self._walls is not None and self._walls.any():
            margins = evaluation.trajectory(controls)[1]
            violation = float(np.maximum(-margins[self._walls], 0.0).sum())
        return Iterate(controls, cost, gradient, violation)

    def _step(self) -> Step:
        assert self._walls is not None
        controls, inputs = self.iterate.controls, self._parameters.inputs
        return self._model.step(controls, inputs, self._tools.qp_solver, self._multipliers, self._walls)

    def _feasible_walls(self, margins: Vector) -> Mask:
        """The nearest obstacle of each stage where the search begins at its distance: constraining it is feasible."""
        walls = np.zeros(margins.shape, dtype=bool)
        if self._tools.hard_clearance:
            stages, nearest = np.arange(len(margins)), margins.argmin(axis=1)
            walls[stages, nearest] = margins[stages, nearest] >= 0.0
        return walls

    def _assess(self, gradient: Vector) -> None:
        """Measures how far the iterate is from optimal by the gradient of the cost there."""
        controls, scale = self.iterate.controls, self._scale
        self._gradient = gradient.reshape(controls.shape) + self._wall_force
        self.residual = residual(controls, scale * self._gradient, scale * self._curvature, self._parameters.inputs)


def _box_duals(controls: Vector, gradient: Vector, inputs: InputParameters) -> Vector:
    """The multipliers of the input set, shape (N, 3): stationarity makes them the gradient where a bound is active."""
    at_lower = np.where(controls <= inputs.lower + AT_BOUND, np.maximum(gradient, 0.0), 0.0)
    return np.where(controls >= inputs.upper - AT_BOUND, np.minimum(gradient, 0.0), at_lower)
