"""Reads `episodes.jsonl` back into records."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from mala_drake.errors import BadInput
from mala_drake.experiments.episode_record import EpisodeRecord

_PLAIN: Mapping[str, tuple[type, ...]] = {"str": (str,), "int": (int,), "bool": (bool,), "float": (int, float)}


def read_episodes(path: Path) -> tuple[list[EpisodeRecord], bool]:
    """The records of a file, and whether a torn last line was left out: one that was being written.

    Raises:
        BadInput: when the file cannot be read, or another line is not an episode's.
    """
    try:
        lines = path.read_bytes().split(b"\n")
    except OSError as error:
        raise BadInput(str(path), f"cannot be read ({error.strerror})", "a readable file") from None
    records: list[EpisodeRecord] = []
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        try:
            data = json.loads(line)
        except ValueError:
            if number == len(lines):  # Every whole line ends with a newline.
                return records, True
            raise BadInput(f"{path}, line {number}", "is not JSON", "one episode a line") from None
        records.append(_record(data, where=f"{path}, line {number}"))
    return records, False


def _record(data: Any, *, where: str) -> EpisodeRecord:
    """The record of one line; keys that a newer version may have added are passed over."""
    if not isinstance(data, dict):
        raise BadInput(where, "is not an object", "an episode")
    values: dict[str, Any] = {"leg_outcomes": []}  # Not in the file.
    for item in fields(EpisodeRecord):
        if item.name in data:
            values[item.name] = _restored(data[item.name], str(item.type), where=f"{where}: {item.name}")
        elif item.name not in values and item.default is MISSING and item.default_factory is MISSING:
            raise BadInput(where, f"has no {item.name!r}", "a whole episode record")
    return EpisodeRecord(**values)


def _restored(value: Any, kind: str, *, where: str) -> Any:
    """The value as the record has it: what was written as null because it was not finite is NaN again."""
    if kind == "float" and value is None:
        return math.nan
    expected = _PLAIN.get(kind if value is None else kind.removesuffix(" | None"))
    if expected is not None and (not isinstance(value, expected) or (isinstance(value, bool) and kind != "bool")):
        raise BadInput(where, repr(value), f"a value of type {kind}")
    if kind == "dict[str, float]" and isinstance(value, dict):
        return {key: _restored(item, "float", where=f"{where}.{key}") for key, item in value.items()}
    if kind.startswith("list[float]") and isinstance(value, list):
        return [_restored(item, "float", where=where) for item in value]
    if value is None and "None" not in kind:
        raise BadInput(where, "null", f"a value of type {kind}")
    return value
