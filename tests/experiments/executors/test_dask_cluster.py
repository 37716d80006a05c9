"""Calls on a Dask cluster, which is here on this machine."""

from __future__ import annotations

import os
import socket

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments.executors import dask_cluster as mut

distributed = pytest.importorskip("distributed")


@pytest.fixture
def no_client(monkeypatch):
    """No client of Dask's is made, and there is not much patience."""
    monkeypatch.setattr(mut, "_ANSWERING", 0.5)

    def refuse(*arguments, **options):
        raise AssertionError("a client was made")

    monkeypatch.setattr(distributed, "Client", refuse)


def meeting(own, other):
    """Code for a call that waits for the file of another one, a minute at most, and tells where it has waited."""
    wait = f"__import__('time').sleep(0.01) for _ in range(6000) if not __import__('os').path.exists({str(other)!r})"
    return f"(open({str(own)!r}, 'w').close(), [{wait}], __import__('os').getpid())[-1]"


def test_calls_are_spread_over_the_cluster_and_a_key_keeps_its_worker(dask_address, tmp_path):
    places = {}
    with mut.DaskExecutor(eval, address=dask_address) as executor:
        assert executor.capacity == 2
        for turn in range(3):
            for key, other in ("ab", "ba"):  # Each is under way until both are: neither could take the other's place.
                executor.submit(key, meeting(tmp_path / f"{key}{turn}", tmp_path / f"{other}{turn}"))
            for finished in (executor.next_finished(), executor.next_finished()):
                assert finished.error is None
                assert places.setdefault(finished.key, finished.result) == finished.result
    assert len(set(places.values())) == 2
    assert os.getpid() not in places.values()


def test_a_call_that_raises_is_told_and_the_others_go_on(dask_address):
    with mut.DaskExecutor(eval, address=dask_address, jobs=3) as executor:
        assert executor.capacity == 3
        for key, code in (("bad", "1 / 0"), ("good", "1 + 1"), ("better", "2 + 2")):
            executor.submit(key, code)
        answers = {finished.key: finished for finished in (executor.next_finished() for _ in range(3))}
    assert answers["bad"].error == "ZeroDivisionError: division by zero"
    assert (answers["good"].result, answers["better"].result) == (2, 4)


def test_a_scheduler_that_has_gone_is_told_in_one_line(dask_address):
    executor = mut.DaskExecutor(abs, address=dask_address)
    executor.close()
    with pytest.raises(BadInput, match="the scheduler has gone"):
        executor.submit("a", 1)


@pytest.mark.parametrize("scheme", ["tcp", "ws"])
def test_an_address_where_nobody_answers_is_told_in_one_line(scheme, no_client):
    address = f"{scheme}://127.0.0.1:9"
    with pytest.raises(BadInput, match="--address") as caught:
        mut.DaskExecutor(abs, address=address)
    assert address in str(caught.value)
    assert "\n" not in str(caught.value)


def test_somebody_who_is_no_scheduler_is_told_in_one_line(no_client):
    with (
        socket.create_server(("127.0.0.1", 0)) as silent,
        pytest.raises(BadInput, match=r"--address: .* no scheduler has answered within 0\.5 s"),
    ):
        mut.DaskExecutor(abs, address=f"tcp://127.0.0.1:{silent.getsockname()[1]}")


def test_the_address_of_a_worker_is_not_the_schedulers(dask_address):
    with distributed.Client(dask_address, set_as_default=False) as client:
        worker = next(iter(client.nthreads()))
    with pytest.raises(BadInput, match="is that of a Worker"):
        mut.DaskExecutor(abs, address=worker)


@pytest.mark.parametrize(
    "address",
    ["foo", "foo:8786", "tcp://foo", "tcp://:8786", "tcp://foo:0", "tcp://foo:65536", "tcp://foo:port", "http://foo:1"],
)
def test_what_is_no_address_is_told_before_anything_is_asked(address, monkeypatch):
    monkeypatch.setattr(mut, "_trouble_at", None)
    with pytest.raises(BadInput, match="tcp://HOST:PORT") as caught:
        mut.DaskExecutor(abs, address=address)
    assert repr(address) in str(caught.value)


@pytest.mark.parametrize("address", ["tcp://10.0.0.1:8786", "tls://a.b-c.example:1", "ws://[::1]:65535", "wss://h:9"])
def test_these_are_addresses(address):
    mut._check_form(address)
