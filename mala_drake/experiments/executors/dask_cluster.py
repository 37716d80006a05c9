"""Calls on a Dask cluster that is there already."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Hashable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from mala_drake.errors import BadInput
from mala_drake.experiments.executors.abstract_executor import AbstractExecutor, Finished, Function, why

_ANSWERING = 5.0  # Seconds within which whoever is at the address must say that it is a scheduler.
_CONNECTING = 30.0  # Seconds that a scheduler has to take a client in.

_SCHEMES = ("tcp", "tls", "ws", "wss")
_ADDRESS = re.compile(rf"(?:{'|'.join(_SCHEMES)})://(?:\[[0-9a-fA-F:.]+\]|[^\s:/\[\]]+):(\d{{1,5}})")
_MOST_PORT = 65535


class DaskExecutor(AbstractExecutor):
    """Computes on the workers of a Dask scheduler, which must have mala_drake installed.

    Results come back to this process, so workers need no common file system. A worker that is lost costs the calls it
    was working on: Dask repeats them on another one.
    """

    __slots__ = ("_client", "_done", "_function", "_jobs", "_keys", "_places")

    def __init__(self, function: Function, *, address: str, jobs: int | None = None) -> None:
        """Connects to the scheduler.

        Args:
            function: that the workers can import.
            address: of the scheduler, for example tcp://10.0.0.1:8786.
            jobs: how many calls at a time at most; None for one a thread of the cluster.

        Raises:
            BadInput: if the address is none, Dask is not installed, or no scheduler answers at the address.
        """
        _check_form(address)
        try:
            from distributed import Client, as_completed
        except ImportError:
            raise BadInput("--executor", "dask is not installed", 'pip install "mala_drake[dask]"') from None
        # A client that cannot connect is slow to give up, and loud.
        with ThreadPoolExecutor(1) as thread:  # This one may have an event loop already.
            trouble = thread.submit(asyncio.run, _trouble_at(address)).result()
        if trouble:
            raise BadInput("--address", f"{address}: {trouble}", "the address of a Dask scheduler")
        try:
            self._client = Client(address, timeout=_CONNECTING, name="mala_drake", set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise BadInput("--address", f"{address}: {why(error)}", "the address of a Dask scheduler") from None
        self._function = function
        self._jobs = jobs
        self._done: Any = as_completed(loop=self._client.loop)
        self._keys: dict[Any, Hashable] = {}
        self._places: dict[Hashable, str] = {}

    @property
    def capacity(self) -> int:
        """The number of threads that the cluster has now, or of jobs."""
        return self._jobs or max(1, sum(self._client.nthreads().values()))

    def submit(self, key: Hashable, argument: Any) -> None:
        """Sends the call to the worker that had this key last, if it is still there.

        Raises:
            BadInput: when the scheduler has gone for good.
        """
        if self._client.status in ("closing", "closed"):
            raise BadInput("--address", "the scheduler has gone", "one that stays; --resume goes on")
        place = self._places.get(key)
        future = self._client.submit(
            _call, self._function, argument, pure=False, workers=place, allow_other_workers=place is not None
        )
        self._keys[future.key] = key
        self._done.add(future)

    def next_finished(self) -> Finished:
        """Waits for the cluster."""
        future = next(self._done)
        key = self._keys.pop(future.key)
        try:
            result, self._places[key] = future.result()
            return Finished(key, result)
        except Exception as error:
            return Finished(key, error=why(error))

    def close(self) -> None:
        """Leaves the cluster; calls that nobody waits for any more are dropped there."""
        self._client.close()


def _check_form(address: str) -> None:
    found = _ADDRESS.fullmatch(address)
    if found is None or not 0 < int(found[1]) <= _MOST_PORT:
        schemes = ", ".join(f"{scheme}://" for scheme in _SCHEMES[1:])
        raise BadInput("--address", repr(address), f"tcp://HOST:PORT, or likewise with {schemes}")


async def _trouble_at(address: str) -> str | None:
    """Why there is no scheduler at the address, in one line; None if there is one."""
    from distributed.comm import connect
    from distributed.core import send_recv
    from distributed.security import Security

    async def identity() -> Any:
        comm = await connect(address, timeout=_ANSWERING, **Security().get_connection_args("client"))
        try:
            return await send_recv(comm, op="identity")
        finally:
            comm.abort()

    try:
        # The time for connecting is not one for what is said then.
        found = await asyncio.wait_for(identity(), 1.2 * _ANSWERING)
        return None if found["type"] == "Scheduler" else f"is that of a {found['type']}"
    except TimeoutError:
        return f"no scheduler has answered within {_ANSWERING:g} s"
    except Exception as error:  # Whoever else is there may answer with anything.
        return why(error)


def _call(function: Function, argument: Any) -> tuple[Any, str]:
    """The result, and the address of the worker that has computed it."""
    from distributed import get_worker

    return function(argument), get_worker().address
