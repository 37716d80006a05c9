"""What is kept of an executed episode: one JSON object a line of `episodes.jsonl`."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mala_drake.errors import BadInput
from mala_drake.experiments.durable_files import append_durably, writing
from mala_drake.preferences import CRITERIA

EPISODES_FILE = "episodes.jsonl"
_DIGITS = 9  # Of floating-point numbers in results: more than any of them means.

_NOT_WRITTEN = ("leg_outcomes",)  # For who watches a run; in the file, `failure` says why an episode failed.
_NOT_WRITTEN_IF_NONE = (
    "mpc_not_converged",
    "learned_dynamics",
    "dynamics_errors",
    "learned_weights",
    "learned_translation",
    "executed_actions",
)


@dataclass
class EpisodeRecord:
    """One episode as it was executed on the physics; the fields are those of the file, in their order.

    `mpc_failures` counts the solves that the robot was not driven with, `mpc_not_converged` those that had stopped at
    the iteration limit and that it was driven with; it is None in what earlier versions have written, where they are
    among the failures.

    `learned_dynamics` has each learned coefficient of the controller's model with its standard deviation, at the end of
    the episode, and `dynamics_errors` the root mean square errors of v_x, v_y (m/s) and the yaw rate (rad/s) a tick
    ahead, of that model as it was in each tick (`learned`) and of the nominal one (`nominal`). `learned_weights` has
    the factors of the controller's weights by place (position, yaw, velocity, control), and `learned_translation` the
    gains from preferences to its weights. They are not written where none are learned.
    `executed_actions` has an entry an action that has ended, in order: `action`, `outcome`, `external_reward`,
    `closed_loop_cost`, `state_mismatch` and `cost_mismatch`, which `ActionMeter` defines; it is None in what earlier
    versions have written. Clearance and collisions are taken at the plant step; `terminal_errors_m` and the like have
    one entry a leg, null where nothing was measured. Only `timing` depends on the machine.
    """

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
    terminal_errors_m: list[float | None]
    terminal_yaw_errors_rad: list[float | None]
    terminal_speeds_m_s: list[float | None]
    leg_outcomes: list[str]
    mismatches: int
    battery_start: float
    battery_end: float
    mpc_not_converged: int | None = None
    learned_dynamics: dict[str, list[float]] | None = None
    dynamics_errors: dict[str, list[float]] | None = None
    learned_weights: dict[str, list[float]] | None = None
    learned_translation: list[list[float]] | None = None
    executed_actions: list[dict[str, Any]] | None = None
    timing: dict[str, float] = field(default_factory=dict)
    displaced_legs: list[dict[str, Any]] = field(default_factory=list)  # See `DisplacedLegs`.

    def to_json(self) -> str:
        """The record as one line of JSON; numbers that are not finite become null."""
        written = {name: value for name, value in vars(self).items() if name not in _NOT_WRITTEN}
        for name in _NOT_WRITTEN_IF_NONE:
            if written[name] is None:
                del written[name]
        if not self.displaced_legs:
            del written["displaced_legs"]
        return json.dumps(plain(written), ensure_ascii=False)

    @property
    def rated(self) -> bool:
        """Whether the patient rated the episode, in part at least."""
        return any(rating is not None for rating in self.ratings)


def plain(value: Any) -> Any:
    """The value as JSON can hold it: numbers rounded to 9 decimals, those that are not finite as null."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, (bool, int, str)) or value is None:
        return value
    number = float(value)
    return round(number, _DIGITS) if math.isfinite(number) else None


def by_criterion(values: Iterable[float]) -> dict[str, float]:
    """Five numbers under the names of the criteria."""
    return dict(zip(CRITERIA, map(float, values), strict=True))


def timing(
    *, wall_seconds: float, cpu_seconds: float, mpc_seconds: Sequence[float], plan_seconds: Sequence[float]
) -> dict[str, float]:
    """What an episode took to compute: seconds in all, and milliseconds a solve of the MPC and of the planner.

    Args:
        wall_seconds: of the whole episode.
        cpu_seconds: of the whole episode, on all cores together.
        mpc_seconds: of each solve; figures of none are 0.
        plan_seconds: of each replanning; figures of none are 0.
    """
    mpc, plan = (1e3 * np.asarray(seconds if len(seconds) else [0.0]) for seconds in (mpc_seconds, plan_seconds))
    return {
        "wall_s": wall_seconds,
        "cpu_s": cpu_seconds,
        "mpc_median_ms": float(np.median(mpc)),
        "mpc_p95_ms": float(np.percentile(mpc, 95)),
        "mpc_max_ms": float(mpc.max()),
        "plan_median_ms": float(np.median(plan)),
        "plan_p95_ms": float(np.percentile(plan, 95)),
    }


def plan_variant(actions: Sequence[str], task: str = "medication") -> str:
    """The choices that tell one plan of a task from another.

    Of a medication round: pharmacy, supply room, order and bedside; of a meal: dish and bedside. They are read from the
    executed actions; the last one of each kind counts.
    """
    names = [action.strip("()").split()[0] for action in actions]
    sides = ["left" if "left" in name else "right" for name in names if name.startswith("approach_")]
    side = sides[-1] if sides else "none"
    if task == "meal":
        dishes = [name.removeprefix("choose_") for name in names if name.startswith("choose_")]
        return "/".join((dishes[-1] if dishes else "none", side))
    pharmacy = supply = "none"
    order: list[str] = []
    for name in names:
        if name.startswith("go_to_pharmacy_"):
            pharmacy = name.removeprefix("go_to_pharmacy_")
        elif name.startswith("go_to_supply_"):
            supply = name.removeprefix("go_to_supply_").upper()
        if name.startswith("collect_") and (kind := name.split("_")[1]) not in order:
            order.append(kind)
    return "/".join((pharmacy, supply, "-".join(order) or "none", side))


def check_writable(path: Path) -> None:
    """Makes the folder of a file to be written later, and finds out whether that file can be written there.

    Raises:
        BadInput: when it cannot.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput(str(path), f"its folder cannot be made ({error.strerror})", "a writable folder") from None
    if path.is_dir():
        raise BadInput(str(path), "is a folder", "the name of a file")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise BadInput(str(path), "cannot be written (permission denied)", "a writable file")


class EpisodeFile:
    """Appends records to `episodes.jsonl`, each on the disk before the next episode begins."""

    def __init__(self, folder: Path) -> None:
        """Starts an empty file in `folder`, which is made if it is missing.

        Raises:
            BadInput: when the file cannot be written.
        """
        self.path = folder / EPISODES_FILE
        check_writable(self.path)
        with writing(self.path):
            self._file = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)

    def append(self, record: EpisodeRecord) -> None:
        """Writes one record.

        Raises:
            BadInput: when it cannot be written, for example because the disk is full.
        """
        with writing(self.path):
            append_durably(self._file, record.to_json() + "\n")

    def close(self) -> None:
        """Closes the file."""
        os.close(self._file)
