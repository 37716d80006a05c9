"""What all learners have in common: settings that never change, and one vector of numbers that is learned."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from mala_drake.errors import BadInput

FloatArray = npt.NDArray[np.float64]


class AbstractLearner(ABC):
    """Holds settings only; what it has learned is its state, which the caller keeps.

    The caller may be a system with a discrete state, a checkpoint, or a local variable.
    """

    __slots__ = ()

    @abstractmethod
    def initial_state(self) -> FloatArray:
        """The state before anything is learned: (k,), with the same k for all states of one learner."""

    def save(self, state: FloatArray) -> dict[str, Any]:
        """The state as JSON can hold it; `restore` gives it back bit for bit."""
        return {"learner": type(self).__name__, "state": [float(number) for number in state]}

    def restore(self, saved: Mapping[str, Any], *, where: str = "checkpoint") -> FloatArray:
        """The state that `save` was given.

        Raises:
            BadInput: if it is another learner's or not a state of this one.
        """
        if saved.get("learner") != type(self).__name__:
            raise BadInput(f"{where}.learner", repr(saved.get("learner")), repr(type(self).__name__))
        expected_size = self.initial_state().size
        try:
            state = np.array(saved.get("state"), dtype=float)
        except (TypeError, ValueError):
            state = np.array(np.nan)
        if state.shape != (expected_size,) or not np.all(np.isfinite(state)):
            raise BadInput(f"{where}.state", repr(saved.get("state")), f"{expected_size} finite numbers")
        return state
