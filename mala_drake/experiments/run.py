"""Runs a scenario: episode after episode, each in a fresh context of its task's station, learners carried over."""

from __future__ import annotations

import json
import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from pydrake.geometry import Meshcat

from mala_drake.experiments.durable_files import replace_durably
from mala_drake.experiments.episode import Carried, simulate_episode
from mala_drake.experiments.episode_record import EPISODES_FILE, EpisodeFile, EpisodeRecord, check_writable
from mala_drake.experiments.run_summary import SUMMARY_FILE, summarise
from mala_drake.experiments.stations import Stations
from mala_drake.reporting.run_recording import RunRecording
from mala_drake.scenario import Scenario, Validate


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
        BadInput: for a scenario that cannot be simulated or a file that cannot be written, before anything runs; later
            only when what is written does not fit on the disk any more.
    """
    Validate(scenario)
    for path in options.files:
        check_writable(path)
    meshcat = _make_meshcat(options)
    stations = Stations(scenario, meshcat=meshcat)
    stations.of_episode(0)
    recording = _start_recording(scenario, options, meshcat)
    # Only now: what an earlier run has written outlives every mistake in the scenario.
    file = _start_results(options)
    try:
        records = _run_episodes(stations, scenario, options, watcher, file, recording)
    finally:
        if file:
            file.close()
        if recording:
            recording.finish()
    summary = summarise(scenario, records)
    if options.out:
        replace_durably(options.out / SUMMARY_FILE, json.dumps(summary, indent=2) + "\n")
    return summary


def _start_results(options: RunOptions) -> EpisodeFile | None:
    if options.out is None:
        return None
    file = EpisodeFile(options.out)
    # A summary of an earlier run must not stand beside the episodes of this one, should this one be interrupted.
    (options.out / SUMMARY_FILE).unlink(missing_ok=True)
    return file


def _run_episodes(
    stations: Stations,
    scenario: Scenario,
    options: RunOptions,
    watcher: Watcher | None,
    file: EpisodeFile | None,
    recording: RunRecording | None,
) -> list[EpisodeRecord]:
    """One episode after another, each in a fresh context; what was learned and the clock go on."""
    records: list[EpisodeRecord] = []
    carried = Carried()
    for episode in range(scenario.episodes):

        def on_action(seconds: float, text: str, *, episode: int = episode, began: float = carried.seconds) -> None:
            if watcher:
                watcher.on_action(episode, seconds - began, text)
            if recording:
                recording.caption(seconds, f"Episode {episode + 1}: {text}")

        record, carried = simulate_episode(
            stations.of_episode(episode),
            scenario,
            episode=episode,
            carried=carried,
            realtime_rate=options.realtime_rate,
            on_action=on_action,
        )
        records.append(record)
        if file:
            file.append(record)
        if watcher:
            watcher.on_episode(record)
    return records


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
