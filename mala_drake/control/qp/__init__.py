"""Quadratic programs with soft rows, and solvers for them behind one contract."""

from __future__ import annotations

from .soft_box_qp import QpSolution, QpSolver, QpStatus, SoftBoxQp

__all__ = ["QpSolution", "QpSolver", "QpStatus", "SoftBoxQp"]
