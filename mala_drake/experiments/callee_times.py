"""The processor time of one call, by the file of the Python code that it calls.

`cProfile` would tell the same, but from Python 3.12 on it hears of the calls in every thread and keeps them on one
stack: another thread that enters or leaves a function meanwhile makes functions pass for each other's callers.
"""

from __future__ import annotations

import sys
import time
from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import FrameType
from typing import Any, TypeVar

from mala_drake.errors import BadInput

Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class CalleeTimes:
    """Seconds of one call.

    Attributes:
        whole: from its beginning to its end.
        by_file: of these, what it has spent in the Python code that it calls, itself or by way of compiled code, by the
            file of that code. What the code calls in turn counts for it.
    """

    whole: float
    by_file: Mapping[str, float]


def time_callees(
    function: Callable[[], Result], *, clock: Callable[[], float] = time.thread_time
) -> tuple[Result, CalleeTimes]:
    """Calls `function`; what other threads do meanwhile does not count.

    Args:
        function: Python code, or a `partial` of some.
        clock: tells the time in seconds.

    Returns:
        What `function` returns, and its times.

    Raises:
        BadInput: if this thread has a profiler already, which would see no more of what goes on.
        RuntimeError: if the end of the call was not seen, because `function` has set another profiler.
    """
    if sys.getprofile() is not None:
        raise BadInput("profiler", "this thread is being profiled already", "no other profiler")
    by_file: dict[str, float] = defaultdict(float)
    depth = 0
    begun = entered = whole = 0.0
    ended = False

    def see(frame: FrameType, event: str, _: Any) -> None:
        nonlocal depth, begun, entered, whole, ended
        if event == "call":
            depth += 1
            if depth == 2:
                entered = clock()
            elif depth == 1:
                begun = clock()
        elif event == "return":
            depth -= 1
            if depth == 1:
                by_file[frame.f_code.co_filename] += clock() - entered
            elif depth == 0:
                whole, ended = clock() - begun, True

    sys.setprofile(see)
    try:
        result = function()
    finally:
        sys.setprofile(None)
    if not ended:
        raise RuntimeError("the times are not whole: the profiler was taken away before the call ended")
    return result, CalleeTimes(whole, dict(by_file))
