"""Writing files such that a process that is killed, or a machine that stops, leaves them whole."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mala_drake.errors import BadInput

TEMPORARY = ".new"
"""Ends the name of a file that is being written."""


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """What is done inside writes to `path`.

    Raises:
        BadInput: when it cannot, for example because the disk is full.
    """
    try:
        yield
    except OSError as error:
        what = f"cannot be written ({error.strerror or error})"
        raise BadInput(str(path), what, "a place to write to, with room for it") from None


def replace_durably(path: Path, text: str) -> None:
    """Makes `text` the content of the file at `path`, which at any moment holds either the old or the new one.

    Raises:
        BadInput: when it cannot be written; the old content is still there then.
    """
    temporary = path.with_name(path.name + TEMPORARY)
    with writing(path):
        descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
        try:
            _write(descriptor, text.encode())
        finally:
            os.close(descriptor)
        os.replace(temporary, path)
        sync_folder(path.parent)


def append_durably(descriptor: int, text: str) -> None:
    """Appends `text` to an open file and waits until it is on the disk. A kill may leave a part of it."""
    _write(descriptor, text.encode())


def sync_folder(folder: Path) -> None:
    """Waits until the names of the files in `folder` are on the disk."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _write(descriptor: int, data: bytes) -> None:
    while data:
        data = data[os.write(descriptor, data) :]
    os.fsync(descriptor)
