"""The executor that has one process: this one."""

from __future__ import annotations

import math

from mala_drake.experiments.executors import serial as mut


def test_it_computes_one_call_after_another():
    with mut.SerialExecutor(math.sqrt) as executor:
        assert executor.capacity == 1
        for number in (4.0, 9.0):
            executor.submit(number, number)
            finished = executor.next_finished()
            assert (finished.key, finished.result, finished.error) == (number, math.sqrt(number), None)


def test_a_call_that_raises_is_told_and_the_next_one_works():
    with mut.SerialExecutor(math.sqrt) as executor:
        executor.submit("bad", -1.0)
        finished = executor.next_finished()
        assert (finished.key, finished.result) == ("bad", None)
        assert finished.error.startswith("ValueError: ")
        executor.submit("good", 4.0)
        assert executor.next_finished().result == 2.0
