"""The executors by name."""

from __future__ import annotations

import os

from mala_drake.errors import BadInput
from mala_drake.experiments.executors.abstract_executor import AbstractExecutor, Function
from mala_drake.experiments.executors.processes import ProcessExecutor
from mala_drake.experiments.executors.serial import SerialExecutor

EXECUTOR_NAMES = ("processes", "serial", "dask")


def make_executor(
    name: str, function: Function, *, jobs: int | None = None, address: str | None = None
) -> AbstractExecutor:
    """The executor called `name`.

    Args:
        name: one of `EXECUTOR_NAMES`.
        function: to be called.
        jobs: how many calls at a time; None for as many as the machine, or the cluster, has room for.
        address: of the scheduler; for dask, and only for it.

    Raises:
        BadInput: if there is no such executor, or an option does not fit it.
    """
    if name not in EXECUTOR_NAMES:
        raise BadInput("--executor", repr(name), "one of " + ", ".join(EXECUTOR_NAMES))
    if jobs is not None and jobs < 1:
        raise BadInput("--jobs", str(jobs), "a whole number >= 1")
    if (address is None) == (name == "dask"):
        raise BadInput("--address", f"{address or 'none'} with the executor {name}", "the scheduler's, for dask alone")
    if name == "serial":
        if jobs not in (None, 1):
            raise BadInput("--jobs", f"{jobs} with the executor serial", "1")
        return SerialExecutor(function)
    if name == "dask":
        from mala_drake.experiments.executors.dask_cluster import DaskExecutor

        return DaskExecutor(function, address=str(address), jobs=jobs)
    return ProcessExecutor(function, jobs=jobs or len(os.sched_getaffinity(0)))
