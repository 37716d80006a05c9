"""Solvers of the optimal control problem by name."""

from __future__ import annotations

from importlib import import_module
from typing import Protocol

from numpy.typing import ArrayLike

from mala_drake.errors import BadInput

from .optimal_control_problem import OptimalControlProblem
from .parameters import MpcParameters
from .solution import Solution


class Solver(Protocol):
    """The contract of every solver. One instance serves one controller: it owns work arrays."""

    name: str

    def solve(
        self, initial_state: ArrayLike, parameters: MpcParameters, warm_start: ArrayLike | None = None
    ) -> Solution:
        """Solves from `initial_state`, shape (6,), starting the search at `warm_start`, controls of shape (N, 3)."""
        ...


# Modules are imported on demand: the names must be known without paying for every solver's libraries.
_SOLVERS = {
    "snopt": ("snopt", "SnoptShootingSolver"),
    "ipopt": ("ipopt", "IpoptShootingSolver"),
    "rti": ("rti", "RealTimeIterationSolver"),
}

SOLVER_NAMES = tuple(_SOLVERS)
"""What `MakeSolver` accepts."""


def MakeSolver(name: str, problem: OptimalControlProblem, **options: object) -> Solver:
    """A solver for `problem`.

    Args:
        name: one of `SOLVER_NAMES`.
        problem: the problem; it is only read, and may be shared.
        **options: passed to the solver's constructor, for example `tolerance` or `iteration_limit`.

    Raises:
        BadInput: no solver has this name.
    """
    if name not in _SOLVERS:
        raise BadInput("solver", repr(name), f"one of {', '.join(SOLVER_NAMES)}")
    module, class_name = _SOLVERS[name]
    return getattr(import_module(f".{module}", __package__), class_name)(problem, **options)
