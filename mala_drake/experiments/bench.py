"""The benchmarks by name. Times depend on the machine: read them as ratios within one run."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from mala_drake.errors import BadInput

Rows = list[dict[str, Any]]

BENCHMARKS = ("plant", "mpc", "agreement", "plan", "episode", "sensitivities")
"""Each is a module `bench_<name>` with a function of that name that returns rows for a table."""


def run_benchmarks(name: str | None) -> dict[str, Rows]:
    """Rows of the benchmark `name`, or of all of them for None, by name.

    Raises:
        BadInput: there is no such benchmark.
    """
    if name is not None and name not in BENCHMARKS:
        raise BadInput("bench", repr(name), "one of " + ", ".join(BENCHMARKS))
    return {chosen: _benchmark(chosen)() for chosen in ([name] if name else BENCHMARKS)}


def _benchmark(name: str) -> Callable[[], Rows]:
    function: Callable[[], Rows] = getattr(import_module(f"mala_drake.experiments.bench_{name}"), f"bench_{name}")
    return function
