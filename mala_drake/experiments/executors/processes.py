"""Calls in processes of this machine, each kept for many calls."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Hashable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from multiprocessing.resource_tracker import ensure_running
from typing import Any

from mala_drake.experiments.executors.abstract_executor import AbstractExecutor, Finished, Function, why

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")

_ENVIRONMENT = {
    **dict.fromkeys(_THREADS, "1"),
    "GLIBC_TUNABLES": os.environ.get("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1"),
}
"""What libraries read when they are loaded. Processes that compute side by side want one numerical thread each, and
memory in large pages, which saves an episode a twentieth of its processor time."""

_KEYS_OF_A_PROCESS = 10
"""A process that has served so many keys is replaced at the next one. Drake's bindings never give back a diagram with
systems written in Python (Drake's issue 22515), some 15 MB each, but the end of the process does."""


@dataclass(slots=True)
class _Worker:
    process: SpawnProcess
    connection: Connection
    key: Hashable  # Of the call that it works on, or worked on last.
    busy: bool = False
    keys: int = 0  # How many it has served.


class ProcessExecutor(AbstractExecutor):
    """Computes in spawned processes with one numerical thread each.

    They ignore the keyboard's interrupt, which is for the process that conducts them, and end when it does, however it
    ends. The one whose call makes it die is replaced at the next call, and so is one that has served many keys.
    """

    __slots__ = ("_function", "_jobs", "_workers")

    def __init__(self, function: Function, *, jobs: int) -> None:
        """Starts no process yet.

        Args:
            function: that can be imported by name.
            jobs: how many processes at most, >= 1.
        """
        self._function = function
        self._jobs = jobs
        self._workers: list[_Worker] = []

    @property
    def capacity(self) -> int:
        """The number of processes."""
        return self._jobs

    def submit(self, key: Hashable, argument: Any) -> None:
        """Sends the call to the process that had this key last, else to a free or a new one."""
        free = sorted((worker for worker in self._workers if not worker.busy), key=lambda worker: worker.key != key)
        if not free or (free[0].key != key and len(self._workers) < self._jobs):
            free.insert(0, self._start())
        worker = free[0]
        if worker.key != key:
            if worker.keys == _KEYS_OF_A_PROCESS:
                self._end([worker])
                worker = self._start()
            worker.key, worker.keys = key, worker.keys + 1
        worker.busy = True
        with suppress(BrokenPipeError):  # It died while it was free: the next look at it tells how.
            worker.connection.send(argument)

    def next_finished(self) -> Finished:
        """Waits for an answer, or the end of a process that owes one."""
        busy = {worker.process.sentinel: worker for worker in self._workers if worker.busy}
        answering = {worker.connection: worker for worker in busy.values()}
        ready = wait([*answering, *busy])
        # An answer counts even if its process has died since.
        worker = next((answering[each] for each in ready if each in answering), None) or busy[ready[0]]  # type: ignore[index]
        try:
            result, error = worker.connection.recv()
        except (EOFError, ConnectionResetError):
            return Finished(worker.key, error=self._bury(worker))
        worker.busy = False
        return Finished(worker.key, result, error)

    def close(self) -> None:
        """Ends all processes at once."""
        self._end(list(self._workers))

    def _start(self) -> _Worker:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(self._function, theirs), daemon=True)
        with _environment(), _interrupts_held():
            process.start()
        theirs.close()  # So that its end is noticed here.
        worker = _Worker(process, ours, None)
        self._workers.append(worker)
        return worker

    def _end(self, workers: Sequence[_Worker]) -> None:
        for worker in workers:
            worker.process.kill()
        for worker in workers:
            worker.process.join()
            worker.connection.close()
            self._workers.remove(worker)

    def _bury(self, worker: _Worker) -> str:
        """Forgets a process that has died; says how it did."""
        worker.process.join()
        worker.connection.close()
        self._workers.remove(worker)
        status = worker.process.exitcode or 0
        if status < 0:
            return f"its process was killed by {signal.Signals(-status).name}"
        return f"its process ended with status {status}"


def _serve(function: Function, connection: Connection) -> None:
    """Answers calls for as long as the conducting process lives."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    with suppress(EOFError, ConnectionError):  # The other end is gone, maybe since a call is under way.
        while True:
            argument = connection.recv()
            try:
                result, failure = function(argument), None
            except Exception as error:
                result, failure = None, why(error)
            connection.send((result, failure))


def _end_with_parent() -> None:
    """Leaves at once when the conducting process has ended, killed or not: nobody waits for this one any more."""
    parent = multiprocessing.parent_process()
    assert parent is not None, "only a child of another process serves it"
    wait([parent.sentinel])
    os._exit(1)


@contextmanager
def _environment() -> Iterator[None]:
    """Processes started meanwhile load their libraries with these settings."""
    before = {name: os.environ.get(name) for name in _ENVIRONMENT}
    os.environ.update(_ENVIRONMENT)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Processes started meanwhile inherit that the keyboard's interrupt does not reach them."""
    ensure_running()  # Starting the first process would start the tracker as well, which lets interrupts through again.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
