"""Reads what `run --out` and `experiment --out` have written: every run of every condition, with what is missing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from mala_drake.errors import BadInput
from mala_drake.experiments.episode_reader import read_episodes
from mala_drake.experiments.episode_record import EPISODES_FILE, EpisodeRecord
from mala_drake.experiments.experiment import MAIN, RunName
from mala_drake.experiments.learning_figures import LearningFigures, learning_figures
from mala_drake.patient.profiles import PROFILES
from mala_drake.preferences import CRITERIA
from mala_drake.reporting.plan import missing_beside_others, missing_from_plan, read_plan, scenarios_of

_SEED_FOLDER = "seed_"
_MAIN_NAMES = ("full", "default", "main", "posterior")  # What an experiment without a main condition is measured by.


@dataclass(frozen=True)
class Run:
    """One run: a patient and a seed under a condition, with at least one episode, in their order.

    `earlier_episodes` is how many of the first ones came before a change of the patient's mind.
    """

    condition: str
    profile: str
    seed: int
    episodes: tuple[EpisodeRecord, ...]
    earlier_episodes: int = 0

    @cached_property
    def learning(self) -> LearningFigures:
        """How well the patient's wishes were learned, since a change of mind if there was one."""
        return learning_figures(self.episodes, earlier_episodes=self.earlier_episodes)

    @property
    def final(self) -> EpisodeRecord:
        """The last episode."""
        return self.episodes[-1]

    def of_task(self, task: str) -> tuple[EpisodeRecord, ...]:
        """The episodes of one task."""
        return tuple(record for record in self.episodes if record.task == task)


@dataclass(frozen=True)
class Results:
    """Everything a folder holds.

    Attributes:
        name: of the folder.
        runs: sorted by condition (the main one first), profile and seed.
        scenarios: what was run under each condition, as the folder tells it; empty where it does not.
        notes: what is missing or was left out, in sentences.
    """

    name: str
    runs: tuple[Run, ...]
    scenarios: Mapping[str, Mapping[str, Any]]
    notes: tuple[str, ...]

    @cached_property
    def conditions(self) -> tuple[str, ...]:
        """The conditions, the main one first."""
        return tuple(dict.fromkeys(run.condition for run in self.runs))

    @property
    def main(self) -> str:
        """The condition that the figures show."""
        return self.conditions[0]

    @cached_property
    def profiles(self) -> tuple[str, ...]:
        """The profiles of the main condition."""
        return tuple(dict.fromkeys(run.profile for run in self.of(self.main)))

    @cached_property
    def tasks(self) -> tuple[str, ...]:
        """The tasks of the main condition, in the order in which they first come."""
        return tuple(dict.fromkeys(record.task for run in self.of(self.main) for record in run.episodes))

    def of(self, condition: str, profile: str | None = None) -> tuple[Run, ...]:
        """The runs of a condition, those of one profile if it is given."""
        return tuple(run for run in self.runs if run.condition == condition and profile in (None, run.profile))

    def learner(self, condition: str) -> str:
        """The name of the learner that a condition ran with, as far as the folder tells it."""
        return condition or str(self.told(condition, "learner", "name") or "main")

    def told(self, condition: str, *fields: str) -> Any:
        """A field of the scenario of a condition; None where the folder does not tell it."""
        value: Any = self.scenarios.get(condition, {})
        for name in fields:
            value = value.get(name) if isinstance(value, dict) else None
        return value

    def true_weights(self, profile: str) -> tuple[float, ...] | None:
        """What the patient really wants; None for a patient of whom the folder does not tell it."""
        told = self.told(self.main, "patient", "true_weights")
        if profile not in PROFILES and isinstance(told, list) and len(told) == len(CRITERIA):
            return tuple(float(weight) for weight in told)
        return PROFILES.get(profile)


def load_results(folder: Path, *, only: Iterable[RunName] | None = None) -> Results:
    """Reads a folder of results.

    Args:
        folder: of a run or an experiment.
        only: the runs to look for; None for all that are there.

    Raises:
        BadInput: when the folder holds no episode, or a line that is not an episode's (a torn last line is left out).
    """
    if not folder.is_dir():
        raise BadInput(str(folder), "is not a folder", "one that `run --out` or `experiment --out` has written")
    notes: list[str] = []
    plan = read_plan(folder, notes)
    runs = [run for path in _episode_files(folder, only) if (run := _read_run(folder, path, notes))]
    if not runs:
        expected = f"{EPISODES_FILE} of `run --out` or `experiment --out` in it"
        raise BadInput(str(folder), "has no episodes", expected)
    found = {run.condition for run in runs}
    conditions = [*(plan.conditions if plan else (MAIN, *_MAIN_NAMES)), *sorted(found)]
    profiles = [*PROFILES, *sorted({run.profile for run in runs} - set(PROFILES))]
    runs.sort(key=lambda run: (conditions.index(run.condition), profiles.index(run.profile), run.seed))
    lengths = {RunName(run.condition, run.profile, run.seed): len(run.episodes) for run in runs}
    notes += missing_from_plan(plan, lengths) if plan else missing_beside_others(lengths)
    scenarios = scenarios_of(folder, plan, sorted(found), notes)
    runs = [replace(run, earlier_episodes=_earlier_episodes(scenarios.get(run.condition, {}))) for run in runs]
    return Results(folder.resolve().name, tuple(runs), scenarios, tuple(notes))


def _earlier_episodes(scenario: Mapping[str, Any]) -> int:
    """How many episodes come before a change of mind, as far as the folder tells it."""
    patient = scenario.get("patient")
    told = patient.get("earlier_episodes") if isinstance(patient, dict) else None
    return max(told, 0) if isinstance(told, int) else 0


def _episode_files(folder: Path, only: Iterable[RunName] | None) -> list[Path]:
    """Where the episodes of runs are, sorted."""
    if only is None:
        return sorted(folder.rglob(EPISODES_FILE))
    return sorted(path for run in only if (path := folder / run.folder / EPISODES_FILE).is_file())


def _read_run(folder: Path, path: Path, notes: list[str]) -> Run | None:
    """The run whose episodes `path` holds; None where there is none."""
    place = path.parent.relative_to(folder)
    records, torn = read_episodes(path)
    if torn:
        notes.append(f"The last line of {place / path.name} is torn and left out.")
    if not records:
        return None  # That it is missing is told by what should be there.
    if not place.parts:
        condition, profile, seed = MAIN, records[0].profile, records[0].seed
    elif len(place.parts) in (2, 3) and place.name.removeprefix(_SEED_FOLDER).isdecimal():
        condition = place.parts[0] if len(place.parts) == 3 else MAIN
        profile, seed = place.parts[-2], int(place.name.removeprefix(_SEED_FOLDER))
    else:
        notes.append(f"{place / path.name} is left out: it is in no folder <profile>/seed_<number>.")
        return None
    for number, record in enumerate(records):
        if (record.profile, record.seed) != (profile, seed):
            found = f"an episode of {record.profile}, seed {record.seed}"
            raise BadInput(str(path), found, f"{profile}, seed {seed}, as its folder says")
        if record.episode != number:
            raise BadInput(f"{path}, line {number + 1}", f"episode {record.episode}", f"episode {number}")
    return Run(condition, profile, seed, tuple(records))
