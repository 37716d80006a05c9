"""Command lines, run in this process."""

from __future__ import annotations

import pytest

from mala_drake.cli import main


def call(capfd, *arguments):
    """Exit status, standard output and standard error of a command line."""
    with pytest.raises(SystemExit) as ended:
        main([str(argument) for argument in arguments])
    output = capfd.readouterr()
    return ended.value.code, output.out, output.err


def mistake(capfd, *arguments):
    """The one line that a mistake is told in."""
    status, output, errors = call(capfd, *arguments)
    assert (status, output) == (2, "")
    assert errors.startswith("mala-drake: ")
    assert errors.count("\n") == 1
    return errors
