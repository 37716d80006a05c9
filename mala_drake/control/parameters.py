"""The five action-dependent parameter groups of the optimal control problem (paper, eq. MPCinner, eq. MPC:Pi).

A planned action selects p^w (terminal), p^g (stage cost), p^f (dynamics), p^h (constraints) and p^a (input set). The
values are immutable and validated, so that they can travel on abstract ports as they are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mala_drake.errors import BadInput
from mala_drake.messages import LearnedDynamics, Message, Shape
from mala_drake.ward.routes import BODY_RADIUS

from .model import CONTROL_SIZE, STATE_SIZE

Vector = NDArray[np.float64]

MAX_LATERAL_DAMPING = 12.0
"""1/s; above about 13.9 the Runge-Kutta step of 0.2 s is unstable in the lateral mode."""

STATE_WEIGHTS = (34.0, 34.0, 3.0, 10.4, 10.4, 10.4)
"""Diagonal of Q at the working point (uniform preference weights)."""

CONTROL_WEIGHTS = (3.05, 3.05, 2.35)
"""Diagonal of R at the working point."""

TERMINAL_FACTOR = 100.0
"""Terminal weights over stage weights at the working point."""


def _frozen_array(where: str, value: ArrayLike, shape: tuple[int | None, ...]) -> Vector:
    """An immutable finite copy of `value`; a None in `shape` admits any length there."""
    array = np.array(value, dtype=float)
    if len(array.shape) != len(shape) or any(w is not None and n != w for n, w in zip(array.shape, shape, strict=True)):
        raise BadInput(where, f"shape {array.shape}", f"shape {shape}")
    if not np.isfinite(array).all():
        raise BadInput(where, "a value that is not finite", "finite numbers")
    array.setflags(write=False)
    return array


def _require(where: str, good: bool | np.bool, value: Any, expected: str) -> None:
    if not good:
        raise BadInput(where, str(value), expected)


class _Arrays(Message):
    """Base of groups whose fields are arrays: values are compared by identity, as numpy has no truth value."""

    __slots__ = ()

    def _freeze(self, name: str, shape: tuple[int | None, ...]) -> Vector:
        array = _frozen_array(f"{type(self).__name__}.{name}", getattr(self, name), shape)
        object.__setattr__(self, name, array)
        return array


@dataclass(frozen=True, slots=True, eq=False)
class TerminalParameters(_Arrays):
    """p^w: the terminal cost (z_N - target)' diag(weights) (z_N - target), yaw error wrapped."""

    target: Vector  # Shape (6,), the state wanted at the end of the horizon.
    weights: Vector = field(default_factory=lambda: TERMINAL_FACTOR * np.array(STATE_WEIGHTS))  # Shape (6,), >= 0.

    def __post_init__(self) -> None:
        self._freeze("target", (STATE_SIZE,))
        weights = self._freeze("weights", (STATE_SIZE,))
        _require("TerminalParameters.weights", (weights >= 0).all(), weights, "non-negative numbers")


@dataclass(frozen=True, slots=True, eq=False)
class StageParameters(_Arrays):
    """p^g: the stage cost (z_k - reference_k)' Q (z_k - reference_k) + u_k' R u_k with diagonal Q and R."""

    references: Vector  # Shape (N, 6), the state wanted at stage k = 0 ... N - 1.
    state_weights: Vector = field(default_factory=lambda: np.array(STATE_WEIGHTS))  # Shape (6,), >= 0.
    control_weights: Vector = field(default_factory=lambda: np.array(CONTROL_WEIGHTS))  # Shape (3,), > 0.

    def __post_init__(self) -> None:
        self._freeze("references", (None, STATE_SIZE))
        state_weights = self._freeze("state_weights", (STATE_SIZE,))
        control_weights = self._freeze("control_weights", (CONTROL_SIZE,))
        _require("StageParameters.state_weights", (state_weights >= 0).all(), state_weights, "non-negative numbers")
        _require("StageParameters.control_weights", (control_weights > 0).all(), control_weights, "positive numbers")


@dataclass(frozen=True, slots=True)
class DynamicsParameters(Message):
    """p^f: the coefficients of the prediction model, in the order of `model.DynamicsIndex`."""

    lateral_damping: float = 5.0  # k, 1/s.
    lateral_coupling: float = 0.0  # g, dimensionless: lateral acceleration per v_x omega.
    yaw_coupling: float = 0.0  # c, 1/m: yaw deceleration per v_x omega.
    propulsion_gain: float = 1.0
    brake_gain: float = 1.0
    yaw_gain: float = 1.0

    def __post_init__(self) -> None:
        _frozen_array("DynamicsParameters", self.vector, (None,))
        damping = self.lateral_damping
        _require("DynamicsParameters.lateral_damping", 0 <= damping <= MAX_LATERAL_DAMPING, damping, "0 to 12 1/s")
        for name in ("propulsion_gain", "brake_gain", "yaw_gain"):
            _require(f"DynamicsParameters.{name}", getattr(self, name) > 0, getattr(self, name), "a positive gain")

    @property
    def vector(self) -> Vector:
        """The coefficients as an array of shape (6,)."""
        return np.array(
            (
                self.lateral_damping,
                self.lateral_coupling,
                self.yaw_coupling,
                self.propulsion_gain,
                self.brake_gain,
                self.yaw_gain,
            )
        )


def learned_parameters(learned: LearnedDynamics) -> DynamicsParameters | None:
    """P^f as it was learned, or None while nothing is."""
    return DynamicsParameters(*learned.coefficients) if learned.updates else None


@dataclass(frozen=True, slots=True, eq=False)
class ConstraintParameters(_Arrays):
    """p^h: path limits, obstacles and the slopes of their exact penalties."""

    speed_limits: Vector  # Shape (N,), largest forward velocity at stage k = 1 ... N, m/s.
    obstacles: tuple[Shape, ...] = ()  # Any number; the problem takes those nearest to its references.
    clearance: float = 0.1  # Distance kept between the robot's body and any obstacle, metres.
    robot_radius: float = BODY_RADIUS  # Metres.
    reverse_limit: float = 0.5  # Largest backward speed, m/s.
    yaw_rate_limit: float = 2.0  # rad/s.
    lateral_limit: float = 2.0  # Largest |v_x omega|, m/s^2.
    obstacle_penalty: float = 1e4  # Cost per metre of lost clearance.
    limit_penalty: float = 1e4  # Cost per m/s, rad/s or m/s^2 beyond a path limit.
    reverse_braking_penalty: float = 1e3  # Cost per m/s^2 of brake and m/s of backward speed.

    def __post_init__(self) -> None:
        limits = self._freeze("speed_limits", (None,))
        _require("ConstraintParameters.speed_limits", (limits >= 0).all(), limits, "non-negative speeds")
        for name in _LIMITS_AND_PENALTIES:
            value = getattr(self, name)
            _require(f"ConstraintParameters.{name}", 0 <= value < math.inf, value, "a finite non-negative number")
        for s in self.obstacles:
            finite = all(map(math.isfinite, (s.x, s.y, s.yaw, s.half_length, s.half_width, s.radius)))
            if not finite:
                raise BadInput(f"obstacle {s.name!r}", str(s), "finite sizes and places")


_LIMITS_AND_PENALTIES = tuple(
    item.name for item in fields(ConstraintParameters) if item.name not in ("speed_limits", "obstacles")
)


@dataclass(frozen=True, slots=True, eq=False)
class InputParameters(_Arrays):
    """p^a: the box of admissible controls, lower <= u_k <= upper."""

    lower: Vector = field(default_factory=lambda: np.array([-2.0, 0.0, -1.0]))  # Shape (3,).
    upper: Vector = field(default_factory=lambda: np.array([2.0, 2.0, 1.0]))  # Shape (3,).

    def __post_init__(self) -> None:
        lower = self._freeze("lower", (CONTROL_SIZE,))
        upper = self._freeze("upper", (CONTROL_SIZE,))
        _require("InputParameters", (lower <= upper).all(), (lower, upper), "lower <= upper")


@dataclass(frozen=True, slots=True, eq=False)
class MpcParameters(Message):
    """All that an action chooses about the optimal control problem: p = (p^w, p^g, p^f, p^h, p^a)."""

    terminal: TerminalParameters
    stage: StageParameters
    constraints: ConstraintParameters
    dynamics: DynamicsParameters = DynamicsParameters()
    inputs: InputParameters = field(default_factory=InputParameters)

    def __post_init__(self) -> None:
        stages, limits = len(self.stage.references), len(self.constraints.speed_limits)
        _require("MpcParameters", stages == limits, f"{stages} references but {limits} speed limits", "one a stage")

    @property
    def horizon(self) -> int:
        """The number of stages N that the references and limits describe."""
        return len(self.stage.references)
