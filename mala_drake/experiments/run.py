"""Runs a scenario: episode after episode on one diagram, each in a fresh context, learners carried over."""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import Simulator

import mala_drake
from mala_drake.clock import TICK
from mala_drake.experiments.episode_record import EPISODES_FILE, EpisodeFile, EpisodeRecord, check_writable, plain
from mala_drake.experiments.episode_watch import EpisodeWatch
from mala_drake.learning.convergence import convergence_episode
from mala_drake.reporting.run_recording import RunRecording
from mala_drake.scenario import Scenario, Validate
from mala_drake.station import MakeCareStation, StartEpisode, learner_state_of

SUMMARY_FILE = "summary.json"


class Watcher(Protocol):
    """Whoever wants to see a run as it goes."""

    def on_action(self, episode: int, seconds: float, text: str) -> None:
        """The robot begins an action of an episode, at `seconds` of it."""

    def on_episode(self, record: EpisodeRecord) -> None:
        """An episode has ended."""


@dataclass(frozen=True)
class RunOptions:
    """How to run and what to write.

    Attributes:
        out: folder of `episodes.jsonl` and `summary.json`, which replace those of an earlier run; None for none.
        html: file of the recording; None for none.
        realtime_rate: simulated seconds per wall second at most; 0 is as fast as possible.
        live: whether the run can be watched in Meshcat.
    """

    out: Path | None = Path("results")
    html: Path | None = None
    realtime_rate: float = 0.0
    live: bool = False

    @property
    def files(self) -> tuple[Path, ...]:
        """What a run that ends by itself has written."""
        results = (self.out / EPISODES_FILE, self.out / SUMMARY_FILE) if self.out else ()
        return (*results, *([self.html] if self.html else []))


def run_scenario(scenario: Scenario, options: RunOptions, *, watcher: Watcher | None = None) -> dict[str, Any]:
    """Simulates every episode of `scenario` and returns the summary that `summary.json` holds.

    Results are appended to `options.out` as they come; what was written stays, whatever happens later.

    Raises:
        BadInput: for a scenario that cannot be simulated or a file that cannot be written, before anything runs.
    """
    Validate(scenario)
    for path in options.files:
        check_writable(path)
    meshcat = _make_meshcat(options)
    station = MakeCareStation(scenario, meshcat=meshcat)
    recording = _start_recording(scenario, options, meshcat)
    # Only now: what an earlier run has written outlives every mistake in the scenario.
    file = _start_results(options)
    try:
        records = _run_episodes(station, scenario, options, watcher, file, recording)
    finally:
        if file:
            file.close()
        if recording:
            recording.finish()
    summary = summarise(scenario, records)
    if options.out:
        text = json.dumps(summary, indent=2)
        (options.out / SUMMARY_FILE).write_text(text + "\n", encoding="utf-8")
    return summary


def _start_results(options: RunOptions) -> EpisodeFile | None:
    if options.out is None:
        return None
    file = EpisodeFile(options.out)
    # A summary of an earlier run must not stand beside the episodes of this one, should this one be interrupted.
    (options.out / SUMMARY_FILE).unlink(missing_ok=True)
    return file


def _run_episodes(
    station: Any,
    scenario: Scenario,
    options: RunOptions,
    watcher: Watcher | None,
    file: EpisodeFile | None,
    recording: RunRecording | None,
) -> list[EpisodeRecord]:
    """One episode after another, each in a fresh context; the learner's state and the clock go on."""
    records: list[EpisodeRecord] = []
    learner_state, clock = None, 0.0
    for episode in range(scenario.episodes):
        context = station.CreateDefaultContext()
        StartEpisode(station, context, episode=episode, time=clock, learner_state=learner_state)
        record, clock = _run_episode(station, context, scenario, episode, clock, options, watcher, recording)
        learner_state = learner_state_of(station, context)
        records.append(record)
        if file:
            file.append(record)
        if watcher:
            watcher.on_episode(record)
    return records


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
    limit = ticks + round(scenario.episode_time_limit / TICK)
    while not watch.finished and ticks < limit:
        ticks += 1  # The watch looks at the ports each tick: every report is seen.
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


def summarise(scenario: Scenario, records: Sequence[EpisodeRecord]) -> dict[str, Any]:
    """Totals of a run and its figures by profile, all of it fit for JSON.

    Args:
        scenario: that was run.
        records: of its episodes, at least one.
    """
    successes = sum(record.success for record in records)
    profile = {
        "convergence_episode": convergence_episode(record.distance_to_true for record in records if record.rated),
        "best_distance": min(record.distance_to_true for record in records),
        "final_distance": records[-1].distance_to_true,
        "success_rate": successes / len(records),
        "plan_variants": sorted({record.plan_variant for record in records if record.success}),
    }
    summary: dict[str, Any] = plain(
        {
            "version": mala_drake.__version__,
            "scenario": asdict(scenario),
            "seed": scenario.random_seed,
            "totals": _totals(records),
            "profiles": {scenario.profile_name: profile},
            "timing": {
                "wall_s": sum(record.timing["wall_s"] for record in records),
                "median_episode_wall_s": np.median([record.timing["wall_s"] for record in records]),
                "mpc_median_ms": np.median([record.timing["mpc_median_ms"] for record in records]),
            },
        }
    )
    return summary


def _totals(records: Sequence[EpisodeRecord]) -> dict[str, Any]:
    return {
        "episodes": len(records),
        "successes": sum(record.success for record in records),
        "failures": [record.failure for record in records if record.failure],
        "collisions": sum(record.collisions for record in records),
        "min_clearance_m": min(record.min_clearance_m for record in records),
        "max_terminal_error_m": max((e for r in records for e in r.terminal_errors_m), default=None),
        "max_terminal_yaw_error_rad": max((e for r in records for e in r.terminal_yaw_errors_rad), default=None),
        "max_terminal_speed_m_s": max((e for r in records for e in r.terminal_speeds_m_s), default=None),
        "mpc_solves": sum(record.mpc_solves for record in records),
        "mpc_failures": sum(record.mpc_failures for record in records),
        "simulated_s": sum(record.sim_time_s for record in records),
    }
