"""Conducts an experiment: has the episodes of its runs computed, and writes each as soon as it is there."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from mala_drake.experiments.compute_episode import EpisodeWork
from mala_drake.experiments.episode_reader import read_episodes
from mala_drake.experiments.episode_record import EPISODES_FILE, EpisodeRecord
from mala_drake.experiments.executors import AbstractExecutor
from mala_drake.experiments.experiment import Experiment, RunName
from mala_drake.experiments.run_folder import RunFolder
from mala_drake.fingerprint import fingerprint


class ExperimentWatcher(Protocol):
    """Whoever wants to see an experiment as it goes."""

    def on_nothing_begun(self, folder: Path) -> None:
        """There is nothing in the folder to go on with, which was asked for: the experiment begins anew."""

    def on_start(self, *, runs: int, episodes: int, done: int) -> None:
        """It begins, or goes on: so many runs with so many episodes in all, of which some are done already."""

    def on_episode(self, run: RunName, episode: int) -> None:
        """An episode of a run is written."""

    def on_run(self, run: RunName, records: Sequence[EpisodeRecord], *, earlier_episodes: int) -> None:
        """A run has come to its end; so many of its episodes came before a change of the patient's mind."""

    def on_failure(self, run: RunName, error: str) -> None:
        """A run cannot go on; what it has written stays, and can be gone on from."""


def conduct(
    experiment: Experiment, folder: Path, executor: AbstractExecutor, *, watcher: ExperimentWatcher
) -> dict[RunName, str]:
    """Brings every run to its end, or to where it fails.

    This process alone writes: an executor's other processes only compute. The episodes of one run follow each other,
    those of different runs go on side by side, and a run depends on no other.

    Args:
        experiment: that was begun in `folder`, perhaps long ago.
        folder: of the experiment.
        executor: of `compute_episode`.
        watcher: is told what happens.

    Returns:
        Why runs have failed, by run; empty when none has.

    Raises:
        BadInput: when a run's files cannot be read or written.
    """
    episodes = experiment.base.episodes
    code = fingerprint(experiment.base.ward)
    waiting: deque[RunName] = deque()
    done = 0
    for run in experiment.runs:
        with RunFolder(folder / run.folder) as files:
            done += files.episodes
            if files.episodes < episodes:
                waiting.append(run)
    watcher.on_start(runs=len(experiment.runs), episodes=episodes * len(experiment.runs), done=done)
    active: dict[RunName, RunFolder] = {}
    failures: dict[RunName, str] = {}

    def submit(run: RunName) -> None:
        files = active[run]
        executor.submit(run, EpisodeWork(experiment.scenario(run), files.episodes, files.carried, code))

    try:
        while waiting or active:
            while waiting and len(active) < executor.capacity:
                run = waiting.popleft()
                active[run] = RunFolder(folder / run.folder)
                submit(run)
            finished = executor.next_finished()
            run, files = finished.key, active[finished.key]
            if finished.error is not None:
                failures[run] = f"episode {files.episodes + 1}: {finished.error}"
                watcher.on_failure(run, failures[run])
            else:
                files.append(*finished.result)
                watcher.on_episode(run, files.episodes - 1)
                if files.episodes < episodes:
                    submit(run)
                    continue
                earlier = experiment.scenario(run).patient.earlier_episodes
                watcher.on_run(run, read_episodes(files.path / EPISODES_FILE)[0], earlier_episodes=earlier)
            active.pop(run).close()
    finally:
        for files in active.values():
            files.close()
    return failures
