"""Reads `episodes.jsonl` back into records."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from types import MappingProxyType
from typing import Any

from mala_drake.control.weights_to_costs import DEFAULT_TRANSLATION
from mala_drake.errors import BadInput
from mala_drake.experiments import record_form as form
from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.learning.weight_estimator import WEIGHT_GROUPS
from mala_drake.preferences import CRITERIA

_BY_CRITERION = form.entry(dict.fromkeys(CRITERIA, form.measured))
_WEIGHTS = form.list_of(form.measured, len(CRITERIA))
_OF_LEGS = form.list_of(form.or_null(form.number))
_VELOCITIES = 3  # Of the errors a tick ahead: v_x, v_y and the yaw rate.
_GAIN_ROWS, _GAIN_COLUMNS = DEFAULT_TRANSLATION.gains.shape

_EXECUTED_ACTION = form.entry(
    {"action": form.action},
    {
        "outcome": form.text,
        "external_reward": form.or_null(form.number),
        "closed_loop_cost": form.or_null(form.number),
        "state_mismatch": form.or_null(form.number),
        "cost_mismatch": form.or_null(form.number),
    },
)

_DISPLACED_LEG = form.entry(
    {
        "place": form.text,
        "outcome": form.text,
        "mismatch": form.number,
        "moved": form.flag,
        "x": form.number,
        "y": form.number,
        "distance_to_true_m": form.number,
    },
    {
        "closed_loop_cost": form.or_null(form.number),
        "sensitivity": form.or_null(form.text),
        "sensitivity_deviation": form.or_null(form.number),
    },
)

_FIELDS: Mapping[str, form.Form] = MappingProxyType(
    {
        "episode": form.whole,
        "task": form.text,
        "profile": form.text,
        "seed": form.whole,
        "success": form.flag,
        "failure": form.or_null(form.text),
        "actions": form.list_of(form.action),
        "plan_variant": form.text,
        "plan_cost": form.measured,
        "replans": form.whole,
        "features": _BY_CRITERION,
        "predicted_features": _BY_CRITERION,
        "ratings": form.list_of(form.or_null(form.number), len(CRITERIA)),
        "weights_before": _WEIGHTS,
        "weights_after": _WEIGHTS,
        "weights_std": form.or_null(_WEIGHTS),
        "distance_to_true": form.measured,
        "sim_time_s": form.measured,
        "solver": form.text,
        "mpc_solves": form.whole,
        "mpc_failures": form.whole,
        "min_clearance_m": form.measured,
        "collisions": form.whole,
        "terminal_errors_m": _OF_LEGS,
        "terminal_yaw_errors_rad": _OF_LEGS,
        "terminal_speeds_m_s": _OF_LEGS,
        "mismatches": form.whole,
        "battery_start": form.measured,
        "battery_end": form.measured,
        "mpc_not_converged": form.or_null(form.whole),
        "learned_dynamics": form.or_null(form.mapping_to(form.list_of(form.measured, 2))),
        "dynamics_errors": form.or_null(form.mapping_to(form.list_of(form.measured, _VELOCITIES))),
        "learned_weights": form.or_null(form.mapping_to(form.list_of(form.positive, len(WEIGHT_GROUPS)))),
        "learned_translation": form.or_null(form.list_of(form.list_of(form.number, _GAIN_COLUMNS), 0, _GAIN_ROWS)),
        "executed_actions": form.or_null(form.list_of(_EXECUTED_ACTION)),
        "timing": form.mapping_to(form.measured, key=form.name_with_unit),
        "displaced_legs": form.list_of(_DISPLACED_LEG),
    }
)
"""What each field of a record is; `leg_outcomes` is not in the file."""

_NEEDED = tuple(
    item.name
    for item in fields(EpisodeRecord)
    if item.name in _FIELDS and item.default is MISSING and item.default_factory is MISSING
)


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
    for name in _NEEDED:
        if name not in data:
            raise BadInput(where, f"has no {name!r}", "a whole episode record")
    values = {name: read(data[name], f"{where}: {name}") for name, read in _FIELDS.items() if name in data}
    return EpisodeRecord(**values, leg_outcomes=[])
