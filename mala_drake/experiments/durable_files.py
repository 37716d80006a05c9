"""Writing files such that a process that is killed, or a machine that stops, leaves them whole."""

from __future__ import annotations

import os
from pathlib import Path

TEMPORARY = ".new"
"""Ends the name of a file that is being written."""


def replace_durably(path: Path, text: str) -> None:
    """Makes `text` the content of the file at `path`, which at any moment holds either the old or the new one."""
    temporary = path.with_name(path.name + TEMPORARY)
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
