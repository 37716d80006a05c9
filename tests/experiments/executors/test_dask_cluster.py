"""Calls on a Dask cluster, which is here on this machine."""

from __future__ import annotations

import os

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments.executors import dask_cluster as mut

pytest.importorskip("distributed")


def test_calls_are_spread_over_the_cluster_and_a_key_keeps_its_worker(dask_address):
    places = {}
    with mut.DaskExecutor(eval, address=dask_address) as executor:
        assert executor.capacity == 2
        for _ in range(3):
            for key in "ab":
                executor.submit(key, "__import__('time').sleep(0.2) or __import__('os').getpid()")
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


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense://host"])
def test_an_address_where_nobody_answers_is_told_in_one_line(address, monkeypatch):
    monkeypatch.setattr(mut, "_CONNECTING", 1.0)
    with pytest.raises(BadInput, match="--address") as caught:
        mut.DaskExecutor(abs, address=address)
    assert address in str(caught.value)
