"""Calls on a Dask cluster, which is here on this machine."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

import mala_drake
from mala_drake.errors import BadInput
from mala_drake.experiments.compute_episode import EpisodeWork, compute_episode
from mala_drake.experiments.episode import Carried
from mala_drake.experiments.executors import dask_cluster as mut
from mala_drake.scenario import Scenario

distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def address():
    """The address of a scheduler with two workers, which import this very tree."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = str(Path(mala_drake.__file__).parents[1])
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    try:
        yield cluster.scheduler_address
    finally:
        cluster.close()
        os.environ.pop("PYTHONPATH")
        if before is not None:
            os.environ["PYTHONPATH"] = before


def test_calls_are_spread_over_the_cluster_and_a_key_keeps_its_worker(address):
    places = {}
    with mut.DaskExecutor(eval, address=address) as executor:
        assert executor.capacity == 2
        for _ in range(3):
            for key in "ab":
                executor.submit(key, "__import__('time').sleep(0.2) or __import__('os').getpid()")
            for finished in (executor.next_finished(), executor.next_finished()):
                assert finished.error is None
                assert places.setdefault(finished.key, finished.result) == finished.result
    assert len(set(places.values())) == 2
    assert os.getpid() not in places.values()


def test_a_call_that_raises_is_told_and_the_others_go_on(address):
    with mut.DaskExecutor(eval, address=address, jobs=3) as executor:
        assert executor.capacity == 3
        for key, code in (("bad", "1 / 0"), ("good", "1 + 1"), ("better", "2 + 2")):
            executor.submit(key, code)
        answers = {finished.key: finished for finished in (executor.next_finished() for _ in range(3))}
    assert answers["bad"].error == "ZeroDivisionError: division by zero"
    assert (answers["good"].result, answers["better"].result) == (2, 4)


def test_an_episode_is_the_same_there(address):
    work = EpisodeWork(Scenario(episodes=2, episode_time_limit=1.0), 1, Carried(ticks=10))
    with mut.DaskExecutor(compute_episode, address=address) as executor:
        executor.submit("run", work)
        (line, carried) = executor.next_finished().result
    here, carried_here = compute_episode(work)
    record, record_here = json.loads(line), json.loads(here)
    assert record.pop("timing").keys() == record_here.pop("timing").keys()
    assert record == record_here
    assert carried == carried_here


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense://host"])
def test_an_address_where_nobody_answers_is_told_in_one_line(address, monkeypatch):
    monkeypatch.setattr(mut, "_CONNECTING", 1.0)
    with pytest.raises(BadInput, match="--address") as caught:
        mut.DaskExecutor(abs, address=address)
    assert address in str(caught.value)
