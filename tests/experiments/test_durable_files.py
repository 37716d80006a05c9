"""Files that are whole whatever happens."""

from __future__ import annotations

import os

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import durable_files as mut


def test_a_file_is_made_and_replaced(tmp_path):
    for text in ("first", "second, and longer ü", "third"):
        mut.replace_durably(tmp_path / "file", text)
        assert (tmp_path / "file").read_text(encoding="utf-8") == text
        assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_write_that_fails_leaves_the_old_content(tmp_path, monkeypatch):
    mut.replace_durably(tmp_path / "file", "old")

    def full(descriptor, data):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "write", full)
        with pytest.raises(BadInput, match=r"file: cannot be written \(No space left on device\)"):
            mut.replace_durably(tmp_path / "file", "new")
    assert (tmp_path / "file").read_text() == "old"


def test_what_the_system_writes_in_pieces_is_written_to_the_end(tmp_path, monkeypatch):
    real = os.write
    descriptor = os.open(tmp_path / "file", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    with monkeypatch.context() as patch:
        patch.setattr(os, "write", lambda where, data: real(where, data[:3]))
        mut.append_durably(descriptor, "a line of its own\n")
    os.close(descriptor)
    assert (tmp_path / "file").read_text() == "a line of its own\n"
