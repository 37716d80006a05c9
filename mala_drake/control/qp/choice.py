"""QP solvers by name."""

from __future__ import annotations

from importlib import import_module

from mala_drake.errors import BadInput

from .soft_box_qp import QpSolver

# Modules are imported on demand, as their libraries take a moment.
_SOLVERS = {
    "daqp": ("daqp", "DaqpSolver"),
    "clarabel": ("drake", "ClarabelQpSolver"),
    "osqp": ("drake", "OsqpQpSolver"),
}

QP_SOLVER_NAMES = tuple(_SOLVERS)
"""What `MakeQpSolver` accepts."""


def MakeQpSolver(name: str) -> QpSolver:
    """A QP solver.

    Raises:
        BadInput: no QP solver has this name.
    """
    if name not in _SOLVERS:
        raise BadInput("qp_solver", repr(name), f"one of {', '.join(QP_SOLVER_NAMES)}")
    module, class_name = _SOLVERS[name]
    return getattr(import_module(f".{module}", __package__), class_name)()
