"""The folder of one run of an experiment: its episodes, and the checkpoint from which it goes on after a kill."""

from __future__ import annotations

import json
import os
from pathlib import Path
from types import TracebackType
from typing import Any

from mala_drake.errors import BadInput
from mala_drake.experiments.durable_files import append_durably, replace_durably, writing
from mala_drake.experiments.episode import Carried
from mala_drake.experiments.episode_record import EPISODES_FILE

CHECKPOINT_FILE = "checkpoint.json"


class RunFolder:
    """`episodes.jsonl` and `checkpoint.json` of a run, written by one process at a time.

    The checkpoint holds what is carried on after the newest two numbers of episodes. It is replaced as a whole *before*
    the newest episode's line is appended. So, wherever a process is killed, the number of whole lines is one of the
    two: no finished line is lost and none is written twice. Should the files disagree all the same, because somebody
    changed them, the run goes on from the newest episode that both know, which costs time but no truth: an episode
    depends on nothing else.
    """

    def __init__(self, path: Path) -> None:
        """Opens the folder, which is made if it is missing, and cuts off what cannot be gone on from.

        Raises:
            BadInput: when the folder or its files cannot be made or read.
        """
        self.path = path
        try:
            path.mkdir(parents=True, exist_ok=True)
            self._file = os.open(path / EPISODES_FILE, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        except OSError as error:
            raise BadInput(str(path), f"cannot be written ({error.strerror})", "a writable folder") from None
        ends = _ends_of_lines((path / EPISODES_FILE).read_bytes())
        states = self._checkpoint()
        self.episodes = max(count for count in states if count <= len(ends))
        self.carried = states[self.episodes]
        os.ftruncate(self._file, ends[self.episodes - 1] if self.episodes else 0)
        os.fsync(self._file)

    def __enter__(self) -> RunFolder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def append(self, line: str, carried: Carried) -> None:
        """Adds an episode.

        Args:
            line: its record, without a newline.
            carried: what goes on from it to the next one.

        Raises:
            BadInput: when it cannot be written, for example because the disk is full.
        """
        states = {self.episodes: self.carried, self.episodes + 1: carried}
        data = {"carried_after": {str(count): state.to_json() for count, state in states.items()}}
        replace_durably(self.path / CHECKPOINT_FILE, json.dumps(data, allow_nan=False) + "\n")
        with writing(self.path / EPISODES_FILE):
            append_durably(self._file, line + "\n")
        self.episodes, self.carried = self.episodes + 1, carried

    def close(self) -> None:
        """Closes the file."""
        os.close(self._file)

    def _checkpoint(self) -> dict[int, Carried]:
        """What is carried on, by the number of episodes after which; the beginning is always known."""
        states = {0: Carried()}
        path = self.path / CHECKPOINT_FILE
        if not path.exists():
            return states
        try:
            data: Any = json.loads(path.read_bytes())
            for count, state in data["carried_after"].items():
                states[int(count)] = Carried.from_json(state, where=str(path))
        except (AttributeError, KeyError, TypeError, ValueError):
            raise BadInput(str(path), "is not a checkpoint", "the one that the run has written, or none") from None
        return states


def _ends_of_lines(data: bytes) -> list[int]:
    """Where each of the first lines ends that are whole records, numbered from 0; what is behind them is torn."""
    ends: list[int] = []
    end = 0
    for line in data.splitlines(keepends=True):
        end += len(line)
        if not (line.endswith(b"\n") and _episode(line) == len(ends)):
            break
        ends.append(end)
    return ends


def _episode(line: bytes) -> Any:
    try:
        record = json.loads(line)
    except ValueError:
        return None
    return record.get("episode") if isinstance(record, dict) else None
