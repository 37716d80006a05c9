"""How the parameters of each solve of a leg depend on the few numbers that are learned, and on the state."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mala_drake.control.parameters import MpcParameters
from mala_drake.messages import Message

from .columns import GROUPS, Columns

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class StepParameters(Message):
    """The parameters of one solve, and how they move with the knobs, a vector of m numbers, and with the state."""

    parameters: MpcParameters
    by_knobs: Vector  # d (columns of the parameters) / d knobs, shape (Columns.parameters, m), of their own horizon.
    by_state: Vector | None = None  # The same with respect to z_i, shape (.., 6); None where references do not follow.


class LegParameters(Protocol):
    """What a closed loop is run with."""

    groups: tuple[str, ...]
    """Groups or pieces of p that `by_knobs` and `by_state` touch: no other sensitivity is computed."""

    knobs: int
    """The number m of knobs."""

    def at(self, step: int, state: Vector) -> StepParameters:
        """The parameters of the solve number `step`, in `state`, shape (6,)."""
        ...


class ConstantParameters:
    """The same parameters at every step (the paper's p_t); the knobs are entries of p themselves."""

    def __init__(self, parameters: MpcParameters, columns: Columns, groups: Iterable[str] = GROUPS[:-1]) -> None:
        """Chooses the knobs.

        Args:
            parameters: of every solve.
            columns: of the problem.
            groups: names of groups or pieces of p, whose entries are the knobs in the order given.
        """
        self.groups = tuple(groups)
        entries = columns.of(self.groups)
        self.knobs = len(entries)
        by_knobs = np.zeros((columns.parameters.stop, self.knobs))
        by_knobs[entries, np.arange(self.knobs)] = 1.0
        self._constant = StepParameters(parameters, by_knobs)

    def at(self, step: int, state: Vector) -> StepParameters:  # noqa: ARG002 - constant means that they do not matter.
        """The parameters."""
        return self._constant


class ScheduledParameters:
    """Parameters by the number of the step, whatever the state; the last ones stay."""

    def __init__(self, steps: Sequence[StepParameters], groups: Iterable[str]) -> None:
        """Takes the parameters of each step.

        Args:
            steps: of the first, second ... solve, at least one.
            groups: names of groups or pieces of p that the knobs touch.
        """
        self.groups = tuple(groups)
        self.knobs = steps[0].by_knobs.shape[1]
        self._steps = tuple(steps)

    def at(self, step: int, state: Vector) -> StepParameters:  # noqa: ARG002 - the schedule does not look at the state.
        """The parameters of the solve number `step`."""
        return self._steps[min(step, len(self._steps) - 1)]
