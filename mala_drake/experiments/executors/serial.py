"""One call after another, in this process."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from mala_drake.experiments.executors.abstract_executor import AbstractExecutor, Finished, Function, why


class SerialExecutor(AbstractExecutor):
    """Computes in this very process: for a debugger, and where there is nothing else."""

    __slots__ = ("_function", "_submitted")

    def __init__(self, function: Function) -> None:
        self._function = function
        self._submitted: tuple[Hashable, Any] | None = None

    @property
    def capacity(self) -> int:
        """One."""
        return 1

    def submit(self, key: Hashable, argument: Any) -> None:
        """Keeps the call until its result is asked for."""
        self._submitted = key, argument

    def next_finished(self) -> Finished:
        """Computes the call."""
        assert self._submitted is not None, "nothing was submitted"
        key, argument = self._submitted
        self._submitted = None
        try:
            return Finished(key, self._function(argument))
        except Exception as error:
            return Finished(key, error=why(error))

    def close(self) -> None:
        """Has nothing to do."""
