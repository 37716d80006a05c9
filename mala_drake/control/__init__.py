"""Model predictive control: the parametric optimal control problem, its parameters and its solvers."""

from __future__ import annotations

from .optimal_control_problem import OptimalControlProblem
from .parameters import (
    ConstraintParameters,
    DynamicsParameters,
    InputParameters,
    MpcParameters,
    StageParameters,
    TerminalParameters,
)
from .solution import Solution, Status
from .solver import SOLVER_NAMES, MakeSolver, Solver

__all__ = [
    "SOLVER_NAMES",
    "ConstraintParameters",
    "DynamicsParameters",
    "InputParameters",
    "MakeSolver",
    "MpcParameters",
    "OptimalControlProblem",
    "Solution",
    "Solver",
    "StageParameters",
    "Status",
    "TerminalParameters",
]
