"""Single shooting through Drake's `MathematicalProgram`, built once for any solver of smooth costs in a box."""

from __future__ import annotations

import logging
from operator import methodcaller
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.autodiffutils import AutoDiffXd
from pydrake.solvers import MathematicalProgram, MathematicalProgramResult, SolverInterface, SolverOptions

from . import model
from .buffered_function import BufferedFunction
from .initial_guess import initial_guesses
from .optimal_control_problem import OptimalControlProblem
from .parameters import InputParameters, MpcParameters
from .shooting import LIMITS
from .solution import Solution, Status, invalid_solution, read_only

Vector = NDArray[np.float64]

_LOGGER = logging.getLogger(__name__)
_UNUSABLE = 1e10  # A finite value that no line search accepts, for points where the cost does not exist.
_value = methodcaller("value")


class MathematicalProgramSolver:
    """Solves an `OptimalControlProblem` with a Drake solver that takes gradients.

    The program has the 3 N controls as its only variables, their box as its only constraint and one Python cost, whose
    value and gradient come from CasADi. Parameters change by value between solves; nothing is rebuilt.
    """

    name = ""

    def __init__(self, problem: OptimalControlProblem, *, tolerance: float = 1e-4, iteration_limit: int = 500) -> None:
        """Builds the program.

        Args:
            problem: what to solve.
            tolerance: on first-order optimality of the scaled problem.
            iteration_limit: major iterations; never wall time, so that equal inputs give equal outputs.
        """
        self._problem = problem
        self._tolerance = tolerance
        self._cost_and_gradient = BufferedFunction(problem.cost_and_gradient)
        self._trajectory = BufferedFunction(problem.trajectory)
        self._point = self._cost_and_gradient.arguments[0].reshape(-1, order="F")
        self._gradient = self._cost_and_gradient.results[1].reshape(-1, order="F")
        self._scale = 1.0
        self._failure: Exception | None = None
        self._evaluations = 0

        self._program = MathematicalProgram()
        size = model.CONTROL_SIZE * problem.horizon
        self._variables = self._program.NewContinuousVariables(size, "u")
        self._program.AddCost(self._evaluate, self._variables)
        self._box = self._program.AddBoundingBoxConstraint(np.zeros(size), np.zeros(size), self._variables)
        self._solver = self._make_solver()
        self._options = SolverOptions()
        for option, value in self._make_options(tolerance, iteration_limit).items():
            self._options.SetOption(self._solver.solver_id(), option, value)

    def solve(
        self, initial_state: ArrayLike, parameters: MpcParameters, warm_start: ArrayLike | None = None
    ) -> Solution:
        """Solves from `initial_state`, shape (6,).

        Args:
            initial_state: z_0, shape (6,).
            parameters: the five groups.
            warm_start: controls to start from, shape (N, 3), usually `Solution.shifted()` of the sample before.

        Returns:
            The solution; its status says whether it can be trusted. Nothing is raised for a state that is not finite.

        Raises:
            BadInput: the parameters do not fit the problem's horizon.
        """
        problem = self._problem
        state = np.asarray(initial_state, dtype=float)
        vector = problem.pack(state, parameters)
        finite_start = warm_start is None or bool(np.isfinite(warm_start).all())
        if not (np.isfinite(vector).all() and np.isfinite(state).all() and finite_start):
            slots = problem.layout.slots
            return invalid_solution(problem.horizon, slots, len(LIMITS), model.CONTROL_SIZE, model.STATE_SIZE)
        for function in (self._cost_and_gradient, self._trajectory):
            function.arguments[1][:, 0] = state
            function.arguments[2][:, 0] = vector
        self._failure, self._evaluations = None, 0
        guess = self._best_guess(state, parameters, warm_start)
        return self._read(self._run(guess, parameters), parameters.inputs)

    def _run(self, guess: Vector, parameters: MpcParameters) -> MathematicalProgramResult:
        # The largest weight sets the size of the cost; dividing by it makes one tolerance fit every action.
        self._scale = 1.0 / max(parameters.terminal.weights.max(), parameters.stage.state_weights.max(), 1.0)
        horizon = self._problem.horizon
        lower, upper = np.tile(parameters.inputs.lower, horizon), np.tile(parameters.inputs.upper, horizon)
        self._box.evaluator().set_bounds(lower, upper)
        return self._solver.Solve(self._program, guess.ravel(), self._options)

    def _evaluate(self, variables: NDArray[Any]) -> AutoDiffXd:
        """The scaled cost at Drake's AutoDiff point.

        The cost is bound to all variables in order, so the derivatives of the argument are the identity and the
        gradient is the derivative as it stands. An exception here could make a solver run on: it is kept, and told.
        """
        try:
            self._evaluations += 1
            self._point[:] = np.fromiter(map(_value, variables), float, len(variables))
            self._cost_and_gradient()
            cost = float(self._cost_and_gradient.results[0][0, 0]) * self._scale
            gradient = self._gradient * self._scale
            if np.isfinite(cost) and np.isfinite(gradient).all():
                return AutoDiffXd(cost, gradient)
            self._failure = ArithmeticError("cost or gradient is not finite")
        except Exception as error:
            self._failure = error
        return AutoDiffXd(_UNUSABLE, np.zeros(len(variables)))

    def _best_guess(self, state: Vector, parameters: MpcParameters, warm_start: ArrayLike | None) -> Vector:
        """The guess of lowest cost: a bad warm start must not decide which local optimum is found."""
        best, best_cost = np.zeros((self._problem.horizon, model.CONTROL_SIZE)), np.inf
        for guess in initial_guesses(state, parameters, self._problem.period, warm_start):
            self._point[:] = guess.ravel()
            self._cost_and_gradient()
            cost = float(self._cost_and_gradient.results[0][0, 0])
            if cost < best_cost:
                best, best_cost = guess, cost
        return best

    def _read(self, result: MathematicalProgramResult, inputs: InputParameters) -> Solution:
        horizon, size = self._problem.horizon, model.CONTROL_SIZE
        controls = np.clip(result.GetSolution(self._variables).reshape(horizon, size), inputs.lower, inputs.upper)
        finite = bool(np.isfinite(controls).all())
        controls = controls if finite else np.clip(np.zeros_like(controls), inputs.lower, inputs.upper)
        self._point[:] = controls.ravel()
        self._cost_and_gradient()
        self._trajectory.arguments[0][:] = controls.T
        self._trajectory()
        states, margins, _, obstacle_duals, limit_duals = (np.array(r.T, order="C") for r in self._trajectory.results)
        duals = result.GetDualSolution(self._box).reshape(horizon, size) / self._scale
        optimality = _projected_gradient(controls, self._gradient.reshape(horizon, size), inputs) * self._scale
        status = self._status(result, optimality) if finite and self._failure is None else Status.NUMERICAL
        if self._failure is not None:
            _LOGGER.warning("%s: the cost could not be evaluated: %s", self.name, self._failure)
        return Solution(
            status=status,
            controls=read_only(controls),
            states=read_only(states),
            cost=float(self._cost_and_gradient.results[0][0, 0]),
            iterations=self._evaluations,
            control_duals=read_only(duals),
            obstacle_duals=read_only(obstacle_duals),
            limit_duals=read_only(limit_duals),
            obstacle_margins=read_only(margins),
            optimality=optimality,
        )

    def _status(self, result: MathematicalProgramResult, optimality: float) -> Status:
        """What the solver says, unless the point itself shows better or worse."""
        if optimality <= 10 * self._tolerance:
            return Status.SOLVED
        if self._hit_iteration_limit(result):
            return Status.ITERATION_LIMIT
        return Status.INACCURATE if optimality <= 100 * self._tolerance else Status.NUMERICAL

    def _make_solver(self) -> SolverInterface:
        raise AssertionError("a subclass names its solver")

    def _make_options(self, tolerance: float, iteration_limit: int) -> dict[str, Any]:
        raise AssertionError("a subclass has its options")

    def _hit_iteration_limit(self, result: MathematicalProgramResult) -> bool:
        raise AssertionError("a subclass knows its solver's codes")


def _projected_gradient(controls: Vector, gradient: Vector, inputs: InputParameters) -> float:
    """The largest component of U - P(U - gradient), P the projection on the box: zero exactly at a KKT point."""
    return float(np.abs(controls - np.clip(controls - gradient, inputs.lower, inputs.upper)).max())
