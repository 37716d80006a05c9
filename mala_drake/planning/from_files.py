"""From two files to a plan, with a limit on wall time: what the command line runs."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from mala_drake.errors import BadInput
from mala_drake.planning.plan import Plan
from mala_drake.planning.planner import Planner, SearchName
from mala_drake.planning.state import Amount
from mala_drake.planning.task import PlanningTask


def solve_files(
    domain: str | Path,
    problem: str | Path,
    *,
    weights: Mapping[str, Amount] | Sequence[Amount] | None = None,
    timeout: float | None = None,
    search: SearchName = "astar",
) -> Plan:
    """An optimal plan for a domain and a problem file.

    Args:
        domain: path of the domain file.
        problem: path of the problem file.
        weights: values of the fluents `(w0)`, `(w1)`, ... in order, or by name.
        timeout: seconds of wall time for reading, grounding and search together. Reading is not broken off: nothing is
            begun after it if it took longer.
        search: `astar`, or `ucs` for blind uniform-cost search.

    Raises:
        BadInput: if the files or options cannot be used.
    """
    if timeout is not None and not (math.isfinite(timeout) and timeout > 0):
        raise BadInput("timeout", f"value {timeout}", "a positive number of seconds")
    started = time.monotonic()
    task = PlanningTask.load(domain, problem)
    planner = Planner(task, search)
    if timeout is None:
        return planner.solve(weights=weights)
    left = timeout - (time.monotonic() - started)
    if left <= 0:
        return Plan("timeout", None, (), parse_ms=task.parse_ms)
    return planner.solve(weights=weights, timeout=left)
