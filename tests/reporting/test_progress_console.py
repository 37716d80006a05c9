"""Consoles with a bar: it is for terminals only, and what is printed beside it can be read by programs."""

from __future__ import annotations

from pathlib import Path

import pytest
from rich.progress import MofNCompleteColumn

from mala_drake.reporting import progress_console as mut


class Counter(mut.ProgressConsole):
    def __init__(self, *, quiet=False):
        super().__init__(MofNCompleteColumn(), quiet=quiet)
        self._progress.add_task("", total=3)


@pytest.fixture
def terminal(monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")


@pytest.mark.usefixtures("terminal")
def test_on_a_terminal_there_is_a_bar_on_standard_error(capsys):
    with Counter():
        pass
    output = capsys.readouterr()
    assert "0/3" in output.err
    assert output.out == ""


@pytest.mark.usefixtures("terminal")
def test_the_bar_goes_when_something_fails(capsys):
    with pytest.raises(ZeroDivisionError), Counter():
        raise ZeroDivisionError
    show_cursor, hide_cursor = "\x1b[?25h", "\x1b[?25l"
    errors = capsys.readouterr().err
    assert errors.rindex(show_cursor) > errors.rindex(hide_cursor)


def test_in_a_pipe_there_is_no_bar(capsys):
    with Counter():
        pass
    assert capsys.readouterr() == ("", "")


def test_a_file_is_one_line_however_long_its_path_is(capsys):
    paths = [Path("results") / ("[x]" * 100), Path("b")]
    Counter().show_files(paths)
    assert capsys.readouterr().out == f"wrote {paths[0]}\nwrote b\n"


@pytest.mark.usefixtures("terminal")
def test_quiet_means_nothing_at_all(capsys):
    with Counter(quiet=True) as console:
        console.show_files([Path("a")])
    assert capsys.readouterr() == ("", "")
