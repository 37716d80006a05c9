"""What is kept of an executed episode: one JSON object a line of `episodes.jsonl`."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mala_drake.preferences import CRITERIA

_DIGITS = 9  # Of floating-point numbers in results: more than any of them means.


@dataclass
class EpisodeRecord:
    """One episode as it was executed on the physics; the fields are those of the file, in their order."""

    episode: int
    task: str
    profile: str
    seed: int
    success: bool
    failure: str | None
    actions: list[str]
    plan_variant: str
    plan_cost: float
    replans: int
    features: dict[str, float]
    predicted_features: dict[str, float]
    ratings: list[float | None]
    weights_before: list[float]
    weights_after: list[float]
    weights_std: list[float] | None
    distance_to_true: float
    sim_time_s: float
    solver: str
    mpc_solves: int
    mpc_failures: int
    min_clearance_m: float
    collisions: int
    terminal_errors_m: list[float]
    terminal_yaw_errors_rad: list[float]
    terminal_speeds_m_s: list[float]
    leg_outcomes: list[str]
    mismatches: int
    battery_start: float
    battery_end: float
    timing: dict[str, float] = field(default_factory=dict)

    def to_json(self) -> str:
        """The record as one line of JSON; numbers that are not finite become null."""
        return json.dumps(_plain(vars(self)), ensure_ascii=False)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, (bool, int, str)) or value is None:
        return value
    number = float(value)
    return round(number, _DIGITS) if math.isfinite(number) else None


def by_criterion(values: Iterable[float]) -> dict[str, float]:
    """Five numbers under the names of the criteria."""
    return dict(zip(CRITERIA, map(float, values), strict=True))


def milliseconds(name: str, seconds: Sequence[float]) -> dict[str, float]:
    """Median, 95th percentile and maximum of wall times, in milliseconds, under names that begin with `name`."""
    times = 1e3 * np.asarray(seconds if len(seconds) else [0.0])
    figures = {"median": np.median(times), "p95": np.percentile(times, 95), "max": times.max()}
    return {f"{name}_{figure}_ms": float(value) for figure, value in figures.items()}


def plan_variant(actions: Sequence[str]) -> str:
    """The choices that tell one medication plan from another: pharmacy, supply room, order and bedside.

    They are read from the executed actions; the last one of each kind counts.
    """
    names = [action.strip("()").split()[0] for action in actions]
    pharmacy = supply = side = "none"
    order: list[str] = []
    for name in names:
        if name.startswith("go_to_pharmacy_"):
            pharmacy = name.removeprefix("go_to_pharmacy_")
        elif name.startswith("go_to_supply_"):
            supply = name.removeprefix("go_to_supply_").upper()
        elif name.startswith("approach_"):
            side = "left" if "left" in name else "right"
        if name.startswith("collect_") and (kind := name.split("_")[1]) not in order:
            order.append(kind)
    return "/".join((pharmacy, supply, "-".join(order) or "none", side))


class EpisodeFile:
    """Appends records to `episodes.jsonl`, each on the disk before the next episode begins."""

    def __init__(self, folder: Path) -> None:
        """Starts an empty file in `folder`, which is made if it is missing."""
        folder.mkdir(parents=True, exist_ok=True)
        self.path = folder / "episodes.jsonl"
        self._file = self.path.open("w", encoding="utf-8")

    def append(self, record: EpisodeRecord) -> None:
        """Writes one record and flushes it."""
        self._file.write(record.to_json() + "\n")
        self._file.flush()

    def close(self) -> None:
        """Closes the file."""
        self._file.close()
