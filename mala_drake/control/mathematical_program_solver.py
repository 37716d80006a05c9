"""What SNOPT and IPOPT share: the solve of an optimal control problem through `ShootingProgram`."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.solvers import MathematicalProgramResult, SolutionResult, SolverInterface, SolverOptions

from mala_drake.errors import BadInput

from .evaluation import Evaluation
from .gauss_newton import GaussNewtonModel
from .initial_guess import InitialGuesses
from .optimal_control_problem import OptimalControlProblem
from .optimality import cost_scale, residual, status_of
from .parameters import InputParameters, MpcParameters
from .shooting_program import Run, ShootingProgram
from .solution import Solution, Status, invalid_solution, read_only

Vector = NDArray[np.float64]

_LOGGER = logging.getLogger(__name__)


class MathematicalProgramSolver(ABC):
    """Solves an `OptimalControlProblem` with one of Drake's gradient-based solvers.

    A solve runs in rounds: one that is not done after `round_length` iterations goes on from where it is, with the
    preconditioner of that point. Measured on cold starts beside an obstacle: IPOPT needs a quarter of the evaluations
    in rounds of 40, SNOPT neither gains nor loses and runs in one.
    """

    name: ClassVar[str]
    round_length: ClassVar[int]

    def __init__(
        self,
        problem: OptimalControlProblem,
        *,
        tolerance: float = 1e-4,
        iteration_limit: int = 200,
        hard_clearance: bool = False,
    ) -> None:
        """Builds the program; nothing is rebuilt afterwards.

        Args:
            problem: what to solve.
            tolerance: on first-order optimality of the preconditioned, scaled problem.
            iteration_limit: major iterations; never wall time, so that equal inputs give equal outputs.
            hard_clearance: also constrain the clearance where that is proven feasible, see `hard_clearance.py`.
                Measured on the course of `bench_mpc`: twice the time for the same clearance, hence not the default.

        Raises:
            BadInput: the iteration limit is not positive.
        """
        if iteration_limit < 1:
            raise BadInput("iteration_limit", str(iteration_limit), "a positive number")
        self._problem = problem
        self._tolerance = tolerance
        self._hard_clearance = hard_clearance
        self._program = ShootingProgram(problem, hard_clearance=hard_clearance)
        self._gauss_newton = GaussNewtonModel(problem)
        self._evaluation = Evaluation(problem)
        self._guesses = InitialGuesses(problem)
        self._solver = self._make_solver()
        self._options = SolverOptions()
        self._rounds = -(-iteration_limit // self.round_length)
        for option, value in self._make_options(tolerance, min(iteration_limit, self.round_length)).items():
            self._options.SetOption(self._solver.solver_id(), option, value)

    def solve(
        self, initial_state: ArrayLike, parameters: MpcParameters, warm_start: ArrayLike | None = None
    ) -> Solution:
        """Solves from `initial_state`, shape (6,).

        Args:
            initial_state: z_0.
            parameters: the five groups.
            warm_start: controls to start from, shape (N, 3), usually `Solution.shifted()` of the sample before. The
                search starts at the best of it and the guesses of `initial_guess.py`.

        Returns:
            The solution; its status says whether it can be trusted. Nothing is raised for a state that is not finite.

        Raises:
            BadInput: the parameters do not fit the problem's horizon.
        """
        state = np.asarray(initial_state, dtype=float)
        packed = self._problem.pack(state, parameters)
        if not (np.isfinite(packed).all() and np.isfinite(state).all()):
            return invalid_solution(self._problem.layout)
        self._program.set_parameters(state, packed)
        self._evaluation.set(state, packed)

        # An absurd state overflows somewhere; every result is checked for that, so numpy need not warn as well.
        with np.errstate(over="ignore", invalid="ignore"):
            guesses = self._guesses(state, parameters, warm_start)
            return self._run_rounds(self._evaluation.best(guesses)[0], packed, parameters)

    def _run_rounds(self, origin: Vector, packed: Vector, parameters: MpcParameters) -> Solution:
        evaluations = 0
        for _ in range(self._rounds):
            solution = self._run_round(origin, packed, parameters, evaluations)
            evaluations = solution.iterations
            if solution.status is Status.SOLVED or self._program.failure is not None:
                break
            origin = solution.controls
        return solution

    def _run_round(self, origin: Vector, packed: Vector, parameters: MpcParameters, evaluations: int) -> Solution:
        """One run of the solver from `origin`, preconditioned there; `evaluations` were spent before."""
        states, margins, *_ = self._evaluation.trajectory(origin)
        hessian = self._gauss_newton.hessian(states, origin, packed, parameters.stage.control_weights)
        scale = cost_scale(parameters)
        run = self._program.run(
            self._solver,
            self._options,
            origin=origin,
            hessian=hessian,
            scale=scale,
            inputs=parameters.inputs,
            margins=margins,
        )
        return self._report(run, scale, np.diag(hessian), parameters.inputs, evaluations)

    def _report(self, run: Run, scale: float, curvature: Vector, inputs: InputParameters, evaluations: int) -> Solution:
        controls = run.controls
        broken = not np.isfinite(controls).all()
        if broken:
            controls = np.clip(np.zeros_like(controls), inputs.lower, inputs.upper)
        cost, gradient = self._evaluation.cost_and_gradient(controls)
        states, obstacle_margins, _, obstacle_duals, limit_duals = self._evaluation.trajectory(controls)
        optimality = residual(controls, scale * gradient, scale * curvature, inputs)
        failure = self._program.failure
        if failure is not None:
            _LOGGER.warning("%s: the cost could not be evaluated: %s", self.name, failure)
        status = Status.NUMERICAL if broken or failure is not None else self._status(run.result, optimality)
        return Solution(
            status=status,
            controls=read_only(controls),
            states=read_only(states),
            cost=cost,
            iterations=evaluations + self._program.evaluations,
            control_duals=read_only(run.control_duals),
            obstacle_duals=read_only(obstacle_duals + run.clearance_duals),
            limit_duals=read_only(limit_duals),
            obstacle_margins=read_only(obstacle_margins),
            optimality=optimality,
        )

    def _status(self, result: MathematicalProgramResult, optimality: float) -> Status:
        """The solver's word, or the point itself: a line search may stop at a perfectly good optimum.

        With hard clearance only the solver knows, because the point's residual leaves those constraints out.
        """
        if result.is_success():
            return Status.SOLVED
        at_limit = result.get_solution_result() == SolutionResult.kIterationLimit
        stopped = Status.ITERATION_LIMIT if at_limit else Status.NUMERICAL
        return stopped if self._hard_clearance else status_of(optimality, self._tolerance, stopped)

    @abstractmethod
    def _make_solver(self) -> SolverInterface:
        """Drake's solver."""

    @abstractmethod
    def _make_options(self, tolerance: float, iteration_limit: int) -> dict[str, Any]:
        """Its options by name."""
