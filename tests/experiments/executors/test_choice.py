"""Executors by name, and options that do not fit them."""

from __future__ import annotations

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments.executors import choice as mut
from mala_drake.experiments.executors.processes import ProcessExecutor
from mala_drake.experiments.executors.serial import SerialExecutor


def test_processes_are_as_many_as_asked_for_or_as_there_are_cores():
    assert isinstance(mut.make_executor("processes", abs), ProcessExecutor)
    assert mut.make_executor("processes", abs).capacity >= 1
    assert mut.make_executor("processes", abs, jobs=7).capacity == 7


def test_serial_is_one():
    assert isinstance(mut.make_executor("serial", abs), SerialExecutor)
    assert mut.make_executor("serial", abs, jobs=1).capacity == 1


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("threads", {}, "--executor: 'threads'"),
        ("processes", {"jobs": 0}, "--jobs: 0"),
        ("serial", {"jobs": 2}, "--jobs: 2"),
        ("dask", {}, "--address: none"),
        ("processes", {"address": "tcp://host:1"}, "--address: tcp://host:1"),
    ],
)
def test_what_does_not_fit_is_told_in_one_line(name, options, words):
    with pytest.raises(BadInput, match=words):
        mut.make_executor(name, abs, **options)
