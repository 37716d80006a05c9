"""Vectors of three plain scalars, for laws that are needed at every step of the plant.

A scalar is a float, or a symbol when a law is compiled into a CasADi function: one text serves both. On three floats
numpy's overhead is ten times the arithmetic.
"""

from __future__ import annotations

from typing import Any

import casadi

Vector = tuple[Any, Any, Any]


def choose(condition: Any, value: Any, otherwise: Any) -> Any:
    """The scalar `value` where `condition` holds, else `otherwise`; what is not chosen may be NaN or infinite."""
    if isinstance(condition, casadi.SX):
        return casadi.if_else(condition, value, otherwise)
    return value if condition else otherwise


def plus(a: Vector, b: Vector) -> Vector:
    """The sum a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Vector, b: Vector) -> Vector:
    """The difference a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def combined(s: float, a: Vector, t: float, b: Vector) -> Vector:
    """The linear combination s a + t b."""
    return s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """The cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> float:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
