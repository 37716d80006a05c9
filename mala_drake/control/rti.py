"""Gauss-Newton SQP with one iteration a sample, or as many as are asked for: the real-time iteration.

A sample has two phases (paper, Sec. "Real-time MPC"; Diehl, Bock, Schloeder, SIAM J. Control Optim. 43, 2005).
*Preparation* needs a prediction of the state only: it iterates but for the last time, linearises and condenses.
*Feedback* starts when the state is measured: one quadratic program and the check of its step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.errors import BadInput

from .globalisation import Iterate
from .initial_guess import InitialGuesses
from .layout import ParameterLayout
from .optimal_control_problem import OptimalControlProblem
from .parameters import MpcParameters
from .qp.choice import MakeQpSolver
from .solution import Solution, invalid_solution
from .sqp import SqpSearch, SqpTools

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class _Prepared:
    """What preparation leaves for feedback."""

    state: Vector
    packed: Vector
    search: SqpSearch


class RealTimeIterationSolver:
    """`Solver` by sequential quadratic programming with the model of `step_model.py` and a line search on the cost.

    `solve` is `prepare` followed by `feedback` at the same state. Nothing of a solve is kept for the next one but what
    `prepare` prepares, so equal arguments give equal bytes.
    """

    name = "rti"

    def __init__(
        self,
        problem: OptimalControlProblem,
        *,
        sqp_iterations: int = 20,
        tolerance: float = 1e-4,
        hard_clearance: bool = False,
        qp_solver: str = "daqp",
    ) -> None:
        """Builds the functions; nothing is rebuilt afterwards.

        Args:
            problem: what to solve.
            sqp_iterations: at most so many quadratic programs a solve: 1 is the real-time iteration.
            tolerance: on first-order optimality, see `optimality.residual`.
            hard_clearance: also constrain the clearance where it holds already, as `hard_clearance.py` does.
            qp_solver: one of `qp.choice.QP_SOLVER_NAMES`.

        Raises:
            BadInput: the number of iterations is not positive, or no QP solver has the name.
        """
        if sqp_iterations < 1:
            raise BadInput("sqp_iterations", str(sqp_iterations), "a positive number")
        self._problem = problem
        self._sqp_iterations = sqp_iterations
        self._guesses = InitialGuesses(problem)
        self._kept = _kept_in_feedback(problem.layout)
        self._tools = SqpTools(problem, MakeQpSolver(qp_solver), tolerance=tolerance, hard_clearance=hard_clearance)
        self._prepared: _Prepared | None = None

    def solve(
        self, initial_state: ArrayLike, parameters: MpcParameters, warm_start: ArrayLike | None = None
    ) -> Solution:
        """Both phases at once; see `Solver`.

        Raises:
            BadInput: the parameters do not fit the problem's horizon.
        """
        state, packed = self._packed(initial_state, parameters)
        if packed is None:
            return invalid_solution(self._problem.layout)
        self._prepared = self._prepare(state, packed, parameters, warm_start)
        return self._feedback(state, packed, parameters)

    def prepare(
        self, predicted_state: ArrayLike, parameters: MpcParameters, warm_start: ArrayLike | None = None
    ) -> None:
        """The preparation phase: everything that can be done before the state is measured.

        Args:
            predicted_state: the state expected, shape (6,): z_1 of the last solution.
            parameters: those expected.
            warm_start: controls to start from, shape (N, 3): `Solution.shifted()` of the last solution. The search
                starts at the best of it and the guesses of `initial_guess.py`.

        Raises:
            BadInput: the parameters do not fit the problem's horizon.
        """
        state, packed = self._packed(predicted_state, parameters)
        self._prepared = None if packed is None else self._prepare(state, packed, parameters, warm_start)

    def feedback(self, initial_state: ArrayLike, parameters: MpcParameters) -> Solution:
        """The feedback phase: one iteration from the measured state with what was prepared.

        The trajectory, references, limits and obstacles are those of the measured state; sensitivities and condensed
        Hessian are the prepared ones. Without a preparation that fits (none, another action's model or weights), all
        is done here.

        Raises:
            BadInput: the parameters do not fit the problem's horizon.
        """
        state, packed = self._packed(initial_state, parameters)
        if packed is None:
            return invalid_solution(self._problem.layout)
        if self._prepared is None or not np.array_equal(packed[self._kept], self._prepared.packed[self._kept]):
            controls = None if self._prepared is None else self._prepared.search.iterate.controls
            self._prepared = self._prepare(state, packed, parameters, controls)
        return self._feedback(state, packed, parameters)

    def _packed(self, state: ArrayLike, parameters: MpcParameters) -> tuple[Vector, Vector | None]:
        """The state as an array of its own, and p; no p where a number is not finite."""
        own = np.array(state, dtype=float)
        packed = self._problem.pack(own, parameters)
        return own, packed if np.isfinite(packed).all() and np.isfinite(own).all() else None

    def _prepare(
        self, state: Vector, packed: Vector, parameters: MpcParameters, warm_start: ArrayLike | None
    ) -> _Prepared:
        evaluation = self._tools.evaluation
        evaluation.set(state, packed)
        # An absurd state overflows somewhere; every result is checked for that, so numpy need not warn as well.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            guesses = self._guesses(state, parameters, warm_start)
            search = SqpSearch(self._tools, state, packed, parameters, Iterate(*evaluation.best(guesses)))
            search.linearise()
            for _ in range(self._sqp_iterations - 1):
                if search.over:
                    break
                search.advance()
                if not search.over:
                    search.linearise()
        return _Prepared(state, packed, search)

    def _feedback(self, state: Vector, packed: Vector, parameters: MpcParameters) -> Solution:
        prepared = self._prepared
        assert prepared is not None
        search = prepared.search
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            if not (np.array_equal(state, prepared.state) and np.array_equal(packed, prepared.packed)):
                controls = np.clip(search.iterate.controls, parameters.inputs.lower, parameters.inputs.upper)
                self._tools.evaluation.set(state, packed)
                start = Iterate(controls, self._tools.evaluation.cost(controls))
                search = SqpSearch(self._tools, state, packed, parameters, start)
                search.linearise(prepared.search.condensed)
            if not search.over:
                search.advance()
            return search.solution()


def _kept_in_feedback(layout: ParameterLayout) -> NDArray[np.intp]:
    """The entries of p on which what is prepared depends: the weights and the model."""
    names = ("terminal.weights", "stage.state_weights", "stage.control_weights", "dynamics")
    return np.concatenate([np.arange(layout.size)[layout.slices[name]] for name in names])
