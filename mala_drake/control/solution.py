"""What a solve of the optimal control problem returns, whoever solved it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from mala_drake.messages import Message

from .layout import ParameterLayout
from .model import CONTROL_SIZE, STATE_SIZE
from .shooting import LIMITS

Vector = NDArray[np.float64]


class Status(StrEnum):
    """How a solve ended."""

    SOLVED = "solved"  # First-order optimal within the tolerance.
    INACCURATE = "inaccurate"  # No further progress, optimal within a hundred times the tolerance.
    ITERATION_LIMIT = "iteration_limit"  # Stopped early; the controls are admissible but not optimal.
    NUMERICAL = "numerical"  # The solver broke down, or a callback failed or left the finite numbers.
    INVALID_INPUT = "invalid_input"  # The initial state or the warm start was not finite; nothing was solved.


@dataclass(frozen=True, slots=True, eq=False)
class Solution(Message):
    """An optimal trajectory with its multipliers. All arrays are read-only.

    Multipliers follow the convention of `MathematicalProgramResult.GetDualSolution`: the derivative of the optimal
    cost with respect to the bound, so >= 0 at an active lower and <= 0 at an active upper bound.
    """

    status: Status
    controls: Vector  # u_0 ... u_{N-1}, shape (N, 3).
    states: Vector  # z_0 ... z_N, shape (N + 1, 6).
    cost: float  # Including penalties; nan for an invalid input.
    iterations: int  # Evaluations of cost and gradient, which is what a solve costs.
    control_duals: Vector  # Multipliers of the input set, shape (N, 3).
    obstacle_duals: Vector  # Multipliers (>= 0) of margin >= 0 at stages 1 ... N, shape (N, M).
    limit_duals: Vector  # Multipliers (>= 0) of the path limits at stages 1 ... N, shape (N, 6), `shooting.LIMITS`.
    obstacle_margins: Vector  # Predicted distance less required distance at stages 1 ... N, shape (N, M), metres.
    optimality: float  # Largest entry of the gradient projected on the input set.

    @property
    def success(self) -> bool:
        """Whether the controls are a local optimum to working accuracy."""
        return self.status in (Status.SOLVED, Status.INACCURATE)

    @property
    def usable(self) -> bool:
        """Whether the robot can be driven with the controls: admissible, if perhaps stopped before the optimum."""
        stopped = self.status is Status.ITERATION_LIMIT
        return self.success or (stopped and bool(np.isfinite(self.controls).all()))

    def shifted(self) -> Vector:
        """The warm start for the next sample, shape (N, 3): paper, eq. (Shift), (ShiftEnd).

        Each control moves one stage up, and the last two of the new sequence are equal: (ShiftEnd) with its subscripts
        read on the shifted trajectory.
        """
        return np.vstack((self.controls[1:], self.controls[-1:]))


def invalid_solution(layout: ParameterLayout) -> Solution:
    """The answer to an input that is not finite: zero controls, no trajectory."""
    controls = np.zeros((layout.horizon, CONTROL_SIZE))
    return Solution(
        status=Status.INVALID_INPUT,
        controls=read_only(controls),
        states=read_only(np.full((layout.horizon + 1, STATE_SIZE), np.nan)),
        cost=np.nan,
        iterations=0,
        control_duals=read_only(controls.copy()),
        obstacle_duals=read_only(np.zeros((layout.horizon, layout.slots))),
        limit_duals=read_only(np.zeros((layout.horizon, len(LIMITS)))),
        obstacle_margins=read_only(np.full((layout.horizon, layout.slots), np.nan)),
        optimality=np.nan,
    )


def read_only(array: Vector) -> Vector:
    """The array itself, locked against writing."""
    array.setflags(write=False)
    return array
