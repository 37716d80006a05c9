"""The contract of everything that computes calls of one function, several at a time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from types import TracebackType
from typing import Any

Function = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Finished:
    """A call that has ended.

    Attributes:
        key: as it was submitted.
        result: of the function; None when there is none.
        error: why there is no result, in one line; None when there is one.
    """

    key: Any
    result: Any = None
    error: str | None = None


class AbstractExecutor(ABC):
    """Calls one function with many arguments, at most `capacity` at a time.

        with SerialExecutor(function) as executor:
            executor.submit("a", 1)
            finished = executor.next_finished()

    A call that raises, or whose process dies, is told as an error in its own `Finished`; the others go on.
    """

    __slots__ = ()

    @property
    @abstractmethod
    def capacity(self) -> int:
        """How many calls can be under way at a time, >= 1; it may change while an executor works."""

    @abstractmethod
    def submit(self, key: Hashable, argument: Any) -> None:
        """Begins `function(argument)`, for which there must be capacity.

        Args:
            key: which no call under way has. A call goes where the one before it with this key was, if that is free.
            argument: that can be pickled, like the result.
        """

    @abstractmethod
    def next_finished(self) -> Finished:
        """Waits for a call under way to end, of which there must be one."""

    @abstractmethod
    def close(self) -> None:
        """Gives up what is under way, and every process with it."""

    def __enter__(self) -> AbstractExecutor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()


def why(error: BaseException) -> str:
    """What was raised, in one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}".rstrip(": ")
