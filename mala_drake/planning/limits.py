"""When to give up: a number of expansions, or a moment of wall time."""

from __future__ import annotations

import time


class OutOfBudget(Exception):
    """The limit was reached before the answer was known."""


class Budget:
    """Counts expansions and watches the clock.

    Args:
        max_expansions: the most states to expand, None for no limit.
        timeout: seconds of wall time from now, None for no limit; what it cuts short depends on the machine.
    """

    def __init__(self, *, max_expansions: int | None = None, timeout: float | None = None) -> None:
        self.expanded = 0
        self._most = max_expansions
        self._deadline = None if timeout is None else time.monotonic() + timeout

    def expand(self) -> None:
        """Counts one expansion.

        Raises:
            OutOfBudget: if there is none left, or the time is up.
        """
        if self._most is not None and self.expanded >= self._most:
            raise OutOfBudget
        self.expanded += 1
        self.tick()

    def tick(self) -> None:
        """Looks at the clock, which takes less time than anything that is worth a tick.

        Raises:
            OutOfBudget: if the time is up.
        """
        if self._deadline is not None and time.monotonic() > self._deadline:
            raise OutOfBudget
