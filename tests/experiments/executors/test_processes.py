"""Calls in other processes, of functions that every process knows."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

import mala_drake
from mala_drake.experiments.executors import processes as mut


def collect(executor, count):
    return [executor.next_finished() for _ in range(count)]


def test_calls_go_to_several_processes_and_each_answer_has_its_key():
    with mut.ProcessExecutor(abs, jobs=2) as executor:
        assert executor.capacity == 2
        for number in (-1, -2):
            executor.submit(number, number)
        answers = collect(executor, 2)
    assert {answer.key: answer.result for answer in answers} == {-1: 1, -2: 2}
    assert [answer.error for answer in answers] == [None, None]


def test_a_key_keeps_its_process_and_another_does_not_take_it_away():
    with mut.ProcessExecutor(eval, jobs=2) as executor:
        places = {}
        for _ in range(3):
            for key in "ab":
                executor.submit(key, "__import__('os').getpid()")
            for answer in collect(executor, 2):
                assert places.setdefault(answer.key, answer.result) == answer.result
        assert len(set(places.values())) == 2
        assert os.getpid() not in places.values()


def test_a_call_that_raises_is_told_and_its_process_goes_on():
    with mut.ProcessExecutor(eval, jobs=1) as executor:
        executor.submit("a", "__import__('os').getpid()")
        place = executor.next_finished().result
        executor.submit("b", "1 / 0")
        assert executor.next_finished().error == "ZeroDivisionError: division by zero"
        executor.submit("c", "__import__('os').getpid()")
        assert executor.next_finished().result == place


def test_a_process_is_replaced_when_it_has_served_many_keys(monkeypatch):
    monkeypatch.setattr(mut, "_KEYS_OF_A_PROCESS", 2)
    others = set(multiprocessing.active_children())  # For example the workers of another test's cluster.
    with mut.ProcessExecutor(eval, jobs=1) as executor:
        places = []
        for key in "aabbcd":
            executor.submit(key, "__import__('os').getpid()")
            places.append(executor.next_finished().result)
        assert len(set(multiprocessing.active_children()) - others) == 1
    first, second = places[0], places[4]
    assert places == [first] * 4 + [second] * 2
    assert first != second


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("__import__('os')._exit(3)", "its process ended with status 3"),
        ("__import__('os').kill(__import__('os').getpid(), 9)", "its process was killed by SIGKILL"),
    ],
)
def test_a_process_that_dies_costs_its_own_call_alone(code, words):
    with mut.ProcessExecutor(eval, jobs=2) as executor:
        executor.submit("well", "sum(range(1000))")
        executor.submit("ill", code)
        answers = {answer.key: answer for answer in collect(executor, 2)}
        assert answers["ill"].error == words
        assert (answers["well"].result, answers["well"].error) == (499500, None)
        executor.submit("next", "1 + 1")
        executor.submit("another", "2 + 2")
        assert {answer.key: answer.result for answer in collect(executor, 2)} == {"next": 2, "another": 4}


def test_a_process_that_dies_between_two_calls_is_noticed_at_the_second():
    with mut.ProcessExecutor(eval, jobs=1) as executor:
        executor.submit("a", "__import__('os').getpid()")
        os.kill(executor.next_finished().result, 9)
        executor._workers[0].process.join()
        executor.submit("b", "1")
        assert executor.next_finished().error == "its process was killed by SIGKILL"
        executor.submit("b", "1")
        assert executor.next_finished().result == 1


def test_libraries_have_one_thread_and_large_pages_there_and_what_is_set_here_stays(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    monkeypatch.setitem(mut._ENVIRONMENT, "GLIBC_TUNABLES", "glibc.malloc.hugetlb=1")
    with mut.ProcessExecutor(os.getenv, jobs=1) as executor:
        for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
            executor.submit(name, name)
            assert executor.next_finished().result == "1"
        executor.submit("memory", "GLIBC_TUNABLES")
        assert "hugetlb" in executor.next_finished().result
    assert os.environ["OMP_NUM_THREADS"] == "7"
    assert "OPENBLAS_NUM_THREADS" not in os.environ


def test_the_interrupt_of_the_keyboard_does_not_reach_the_processes():
    code = "__import__('os').kill(__import__('os').getpid(), 2) or 'alive'"
    with mut.ProcessExecutor(eval, jobs=1) as executor:
        executor.submit("a", code)
        assert executor.next_finished().result == "alive"


def test_it_does_not_reach_the_very_first_process_either():
    code = """if __name__ == "__main__":
    from mala_drake.experiments.executors.processes import ProcessExecutor
    with ProcessExecutor(eval, jobs=1) as executor:
        executor.submit("a", "2 in __import__('signal').pthread_sigmask(0, [])")
        print(executor.next_finished().result)
"""
    folder = Path(mala_drake.__file__).parents[1]
    command, environment = [sys.executable, "-c", code], {**os.environ, "PYTHONPATH": str(folder)}
    told = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    assert told.stdout == "True\n"


def test_an_answer_that_nobody_waits_for_any_more_is_no_error(monkeypatch):
    monkeypatch.setattr(mut, "_end_with_parent", lambda: None)  # The process of this test has no parent of that kind.
    conducting, serving = multiprocessing.Pipe()

    def answer_too_late(number):
        conducting.close()
        return number

    conducting.send(3)
    mut._serve(answer_too_late, serving)


def test_closing_ends_processes_that_are_at_work():
    executor = mut.ProcessExecutor(time.sleep, jobs=2)
    executor.submit("long", 1000.0)
    executor.submit("longer", 2000.0)
    executor.close()  # Returns, that is the test; and so does the suite.
    executor.close()


ORPHANS = """
import os, sys, time
from mala_drake.experiments.executors.processes import ProcessExecutor
executor = ProcessExecutor(eval, jobs=2)
for key in "ab":
    executor.submit(key, "__import__('os').getpid()")
print(*[executor.next_finished().result for _ in "ab"], flush=True)
executor.submit("a", "__import__('time').sleep(1000)")
time.sleep(1000)
"""


def test_processes_end_with_the_one_that_conducts_them_even_if_it_is_killed():
    root = str(Path(mala_drake.__file__).parents[1])
    conductor = subprocess.Popen(
        [sys.executable, "-c", ORPHANS], stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": root}
    )
    assert conductor.stdout is not None
    workers = [int(number) for number in conductor.stdout.readline().split()]
    assert len(Counter(workers)) == 2
    conductor.kill()
    conductor.wait()
    conductor.stdout.close()
    deadline = time.monotonic() + 60.0
    while any(map(_runs, workers)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(map(_runs, workers))


def _runs(process):
    """Whether a process is there and not merely waiting to be buried."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state not in "ZX"
