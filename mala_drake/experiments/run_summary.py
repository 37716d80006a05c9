"""What a run came to: its totals and its figures by profile, as `summary.json` holds them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

import mala_drake
from mala_drake.experiments.episode_record import EpisodeRecord, plain
from mala_drake.experiments.learning_figures import learning_figures
from mala_drake.fingerprint import fingerprint
from mala_drake.scenario import Scenario

SUMMARY_FILE = "summary.json"


def summarise(scenario: Scenario, records: Sequence[EpisodeRecord]) -> dict[str, Any]:
    """Totals of a run and its figures by profile, all of it fit for JSON.

    Args:
        scenario: that was run.
        records: of its episodes, at least one.
    """
    successes = sum(record.success for record in records)
    profile = {
        **asdict(learning_figures(records, earlier_episodes=scenario.patient.earlier_episodes)),
        "success_rate": successes / len(records),
        "plan_variants": sorted({record.plan_variant for record in records if record.success}),
    }
    summary: dict[str, Any] = plain(
        {
            "version": mala_drake.__version__,
            "fingerprint": fingerprint(scenario.ward),
            "scenario": asdict(scenario),
            "seed": scenario.random_seed,
            "totals": totals_of(records),
            "profiles": {scenario.profile_name: profile},
            "timing": timing_of(records),
        }
    )
    return summary


def totals_of(records: Sequence[EpisodeRecord]) -> dict[str, Any]:
    """What was done and what went wrong in these episodes."""
    return {
        "episodes": len(records),
        "successes": sum(record.success for record in records),
        "failures": [record.failure for record in records if record.failure],
        "collisions": sum(record.collisions for record in records),
        "min_clearance_m": min((record.min_clearance_m for record in records), default=None),
        "max_terminal_error_m": _worst(record.terminal_errors_m for record in records),
        "max_terminal_yaw_error_rad": _worst(record.terminal_yaw_errors_rad for record in records),
        "max_terminal_speed_m_s": _worst(record.terminal_speeds_m_s for record in records),
        "mpc_solves": sum(record.mpc_solves for record in records),
        "mpc_failures": sum(record.mpc_failures for record in records),
        "mpc_not_converged": sum(record.mpc_not_converged or 0 for record in records),
        "simulated_s": sum(record.sim_time_s for record in records),
    }


def _worst(of_episodes: Iterable[Sequence[float | None]]) -> float | None:
    """The greatest of the figures that were measured, None of none."""
    return max((value for values in of_episodes for value in values if value is not None), default=None)


def timing_of(records: Sequence[EpisodeRecord]) -> dict[str, Any]:
    """What these episodes took to compute, which depends on the machine."""
    timings = [record.timing for record in records]
    return {
        "wall_s": sum(timing["wall_s"] for timing in timings),
        "cpu_s": sum(timing["cpu_s"] for timing in timings),
        "median_episode_wall_s": np.median([timing["wall_s"] for timing in timings]) if timings else None,
        "mpc_median_ms": np.median([timing["mpc_median_ms"] for timing in timings]) if timings else None,
    }
