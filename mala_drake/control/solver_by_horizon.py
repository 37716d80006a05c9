"""A solver for problems of any horizon, for a horizon that shrinks as an action nears its end (paper, eq. MPCinner)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .optimal_control_problem import OptimalControlProblem
from .parameters import MpcParameters
from .solution import Solution
from .solver import MakeSolver, Solver

SHORTEST_HORIZON = 5
"""Stages: a second, in which the robot can still answer to what has pushed it from its pose."""


def solver_of_kind(
    horizon_kind: str, name: str, problem: OptimalControlProblem, **options: object
) -> tuple[Solver, int | None]:
    """The solver of who drives legs, and the least number of stages that its horizon shrinks to.

    Args:
        horizon_kind: "shrinking", to the end of a leg, or else always the problem's, with None for the latter.
        name: of the solver, as `MakeSolver` takes it.
        problem: with the longest horizon.
        **options: of the solver.

    Raises:
        BadInput: no solver has this name.
    """
    if horizon_kind == "shrinking":
        return SolverByHorizon(name, problem, **options), SHORTEST_HORIZON
    return MakeSolver(name, problem, **options), None


class SolverByHorizon:
    """`Solver` whose parameters may describe any horizon: one problem and one solver for each that occurs.

    Each is built at its first use, in well under a second, and kept.
    """

    def __init__(self, name: str, problem: OptimalControlProblem, **options: object) -> None:
        """Takes the solver's name and options as `MakeSolver` does; `problem` gives all but the horizon.

        Raises:
            BadInput: no solver has this name.
        """
        self.name = name
        self._problem = problem
        self._options = options
        self._solvers: dict[int, Solver] = {problem.horizon: MakeSolver(name, problem, **options)}

    def solve(
        self, initial_state: ArrayLike, parameters: MpcParameters, warm_start: ArrayLike | None = None
    ) -> Solution:
        """Solves over the parameters' horizon; see `Solver`.

        A warm start of another length is cut at its end, or its last control is held: as each sample's horizon ends
        where the last one's did, a shifted solution loses the control that the shift made up.
        """
        horizon = parameters.horizon
        if horizon not in self._solvers:
            self._solvers[horizon] = MakeSolver(self.name, self._problem.of_horizon(horizon), **self._options)
        if warm_start is not None:
            controls = np.asarray(warm_start, dtype=float)
            warm_start = controls[np.minimum(np.arange(horizon), len(controls) - 1)]
        return self._solvers[horizon].solve(initial_state, parameters, warm_start)
