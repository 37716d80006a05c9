"""What an experiment is: conditions, patients and seeds, and the runs that follow from them."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import mala_drake
from mala_drake.configuration import typed
from mala_drake.errors import BadInput
from mala_drake.fingerprint import fingerprint
from mala_drake.patient.profiles import PROFILES
from mala_drake.scenario import Scenario, Validate, reset_unused

MAIN = ""
"""The condition whose runs lie in no folder of their own."""

CUSTOM = "custom"
"""The patient with the scenario's own weights, beside the profiles of the paper."""

Changes = Mapping[str, Any]

_PLAIN_NAME = re.compile(r"\w[\w.-]*")


@dataclass(frozen=True, slots=True)
class RunName:
    """One run: a patient and a seed under a condition."""

    condition: str
    profile: str
    seed: int

    @property
    def folder(self) -> Path:
        """Where its files are in the experiment's folder."""
        return Path(self.condition) / self.profile / f"seed_{self.seed}"

    def __str__(self) -> str:
        return ", ".join((*([self.condition] if self.condition else []), self.profile, f"seed {self.seed}"))


@dataclass(frozen=True)
class Experiment:
    """A scenario that is run under several conditions, with several patients and seeds.

    Attributes:
        name: for example "convergence".
        base: the scenario; its patient and its seed are replaced by those of each run.
        conditions: by name, `MAIN` first if there is one, what each changes in the scenario, as its file would.
        profiles: of the patients.
        seeds: of the runs.
    """

    name: str
    base: Scenario
    conditions: Mapping[str, Changes]
    profiles: tuple[str, ...]
    seeds: tuple[int, ...]

    @property
    def runs(self) -> tuple[RunName, ...]:
        """All runs, such that the first ones tell most."""
        return tuple(
            RunName(condition, profile, seed)
            for condition in self.conditions
            for seed in self.seeds
            for profile in self.profiles
        )

    def scenario(self, run: RunName) -> Scenario:
        """What a run simulates.

        Where the condition replaces a choice of the base, as its learner, what the base sets of that choice goes with
        it.

        Raises:
            BadInput: if a change does not fit a scenario.
        """
        where = f"condition {run.condition}" if run.condition else "scenario"
        scenario = typed(Scenario, self.conditions[run.condition], where=where, defaults=self.base)
        reset_unused(scenario)
        scenario.random_seed = run.seed
        if run.profile != CUSTOM:
            scenario.patient.profile, scenario.patient.true_weights = run.profile, []
        return scenario

    def validate(self) -> None:
        """Checks every scenario that is to be run, before any is.

        Raises:
            BadInput: for the first mistake.
        """
        if CUSTOM in self.profiles and not self.base.patient.true_weights:
            raise BadInput("--profiles", repr(CUSTOM), "a scenario with patient.true_weights, for that profile")
        for condition in self.conditions:
            # Profiles are known to exist and seeds to be whole numbers >= 0, and nothing else depends on them.
            scenario = self.scenario(RunName(condition, self.profiles[0], self.seeds[0]))
            Validate(scenario, where=f"condition {condition}" if condition else "")

    def to_json(self) -> dict[str, Any]:
        """Everything that decides what the runs come to."""
        return {
            "version": mala_drake.__version__,
            "fingerprint": fingerprint(self.base.ward),
            "experiment": self.name,
            "scenario": asdict(self.base),
            "conditions": copy.deepcopy(dict(self.conditions)),
            "profiles": list(self.profiles),
            "seeds": list(self.seeds),
        }

    @staticmethod
    def from_json(data: Any, *, where: str) -> Experiment:
        """What `to_json` was called on.

        Raises:
            BadInput: if `data` is not of that form.
        """
        try:
            experiment = Experiment(
                name=str(data["experiment"]),
                base=typed(Scenario, data["scenario"], where=where, defaults=Scenario()),
                conditions=dict(data["conditions"]),
                profiles=tuple(map(str, data["profiles"])),
                seeds=tuple(map(int, data["seeds"])),
            )
        except (KeyError, TypeError, ValueError):
            raise BadInput(where, "does not describe an experiment", "the file that the experiment has made") from None
        for name in (*experiment.conditions, *experiment.profiles):
            if name and not _PLAIN_NAME.fullmatch(name):  # Runs are removed by their names.
                raise BadInput(where, f"has {name!r} as a name", "names of conditions and profiles")
        return experiment


def known_profiles() -> tuple[str, ...]:
    """What a run may call its patient."""
    return (*PROFILES, CUSTOM)
