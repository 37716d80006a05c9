"""Runs a scenario: episode after episode on one diagram, each in a fresh context, learners carried over."""

from __future__ import annotations

import json
import logging
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import Simulator

import mala_drake
from mala_drake.clock import TICK
from mala_drake.experiments.episode_record import EpisodeFile, EpisodeRecord
from mala_drake.experiments.episode_watch import EpisodeWatch
from mala_drake.learning.convergence import convergence_episode
from mala_drake.reporting.run_recording import RunRecording
from mala_drake.scenario import Scenario
from mala_drake.scheduling.sequence import task_names
from mala_drake.station import MakeCareStation, StartEpisode, learner_state_of

_TICKS_AT_ONCE = 1  # The watch looks at the ports each tick: every report is seen.


class Watcher(Protocol):
    """Whoever wants to see a run as it goes."""

    def on_action(self, episode: int, seconds: float, text: str) -> None:
        """The robot begins an action of an episode, at `seconds` of it."""

    def on_episode(self, record: EpisodeRecord) -> None:
        """An episode has ended."""


@dataclass(frozen=True)
class RunOptions:
    """How to run and what to write."""

    out: Path | None = Path("results")
    html: Path | None = None
    realtime_rate: float = 0.0
    live: bool = False


def run_scenario(scenario: Scenario, options: RunOptions, *, watcher: Watcher | None = None) -> dict[str, Any]:
    """Simulates every episode of `scenario` and returns the summary that `summary.json` holds.

    Results are appended to `options.out` as they come; what was written stays, whatever happens later.
    """
    meshcat = _make_meshcat(options)
    station = MakeCareStation(scenario, meshcat=meshcat)
    recording = _start_recording(scenario, options, meshcat)
    names = task_names(scenario.task, episodes=scenario.episodes)
    file = EpisodeFile(options.out) if options.out else None
    records: list[EpisodeRecord] = []
    learner_state, clock = None, 0.0
    try:
        for episode in range(len(names)):
            context = station.CreateDefaultContext()
            StartEpisode(station, context, episode=episode, time=clock, learner_state=learner_state)
            record, clock = _run_episode(station, context, scenario, episode, clock, options, watcher, recording)
            learner_state = learner_state_of(station, context)
            records.append(record)
            if file:
                file.append(record)
            if watcher:
                watcher.on_episode(record)
    finally:
        if file:
            file.close()
        if recording:
            recording.finish()
    summary = summarise(scenario, records)
    if options.out:
        text = json.dumps(summary, indent=2)
        (options.out / "summary.json").write_text(text + "\n", encoding="utf-8")
    return summary


def _run_episode(
    station: Any,
    context: Any,
    scenario: Scenario,
    episode: int,
    started: float,
    options: RunOptions,
    watcher: Watcher | None,
    recording: RunRecording | None,
) -> tuple[EpisodeRecord, float]:
    """Simulates until the episode is rated and learned from, or its time is up."""
    wall = time.perf_counter()
    simulator = Simulator(station, context)
    simulator.set_target_realtime_rate(options.realtime_rate)
    simulator.Initialize()
    watch = EpisodeWatch(station, context, scenario, episode)
    ticks = round(started / TICK)
    limit = ticks + int(scenario.episode_time_limit / TICK)
    while not watch.finished and ticks < limit:
        ticks += _TICKS_AT_ONCE
        simulator.AdvanceTo(ticks * TICK)
        for text in watch.look():
            if watcher:
                watcher.on_action(episode, context.get_time() - started, text)
            if recording:
                recording.caption(context.get_time(), f"Episode {episode + 1}: {text}")
    record = watch.record(wall_seconds=time.perf_counter() - wall)
    return record, ticks * TICK


def _make_meshcat(options: RunOptions) -> Meshcat | None:
    """The viewer, if the run is watched or recorded; only who watches is told its address."""
    if not (options.live or options.html):
        return None
    logger = logging.getLogger("drake")
    level = logger.level
    try:
        logger.setLevel(level if options.live else logging.WARNING)
        return Meshcat()
    finally:
        logger.setLevel(level)


def _start_recording(scenario: Scenario, options: RunOptions, meshcat: Meshcat | None) -> RunRecording | None:
    if options.html is None or meshcat is None:
        return None
    title = f"{scenario.task}, patient {scenario.profile_name.replace('_', ' ')}"
    return RunRecording(meshcat, options.html, scenario.load_ward(), title=title)


def summarise(scenario: Scenario, records: list[EpisodeRecord]) -> dict[str, Any]:
    """Totals of a run and its figures by profile."""
    distances = [record.distance_to_true for record in records]
    successes = sum(record.success for record in records)
    walls = [record.timing["wall_s"] for record in records]
    solve_times = [record.timing["mpc_median_ms"] for record in records]
    profile = {
        "convergence_episode": convergence_episode(distances),
        "best_distance": min(distances),
        "final_distance": distances[-1],
        "success_rate": successes / len(records),
        "plan_variants": sorted({record.plan_variant for record in records if record.success}),
    }
    return {
        "version": mala_drake.__version__,
        "scenario": asdict(scenario),
        "seed": scenario.random_seed,
        "totals": {
            "episodes": len(records),
            "successes": successes,
            "failures": [record.failure for record in records if record.failure],
            "collisions": sum(record.collisions for record in records),
            "min_clearance_m": min(record.min_clearance_m for record in records),
            "max_terminal_error_m": max((e for r in records for e in r.terminal_errors_m), default=None),
            "max_terminal_yaw_error_rad": max((e for r in records for e in r.terminal_yaw_errors_rad), default=None),
            "max_terminal_speed_m_s": max((e for r in records for e in r.terminal_speeds_m_s), default=None),
            "mpc_solves": sum(record.mpc_solves for record in records),
            "mpc_failures": sum(record.mpc_failures for record in records),
            "simulated_s": sum(record.sim_time_s for record in records),
        },
        "profiles": {scenario.profile_name: profile},
        "timing": {
            "wall_s": sum(walls),
            "median_episode_wall_s": float(np.median(walls)),
            "mpc_median_ms": float(np.median(solve_times)),
        },
    }
