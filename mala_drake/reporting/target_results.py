"""What became of the targets of places that are not where the map says, run by run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from mala_drake.configuration import typed
from mala_drake.errors import BadInput
from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.experiments.target_summary import is_mismatch, updates_until_gone
from mala_drake.reporting.paper_results import PAPER_TARGET_UPDATES
from mala_drake.reporting.results import Results, Run
from mala_drake.scenario import Scenario
from mala_drake.ward.ward_map import Ward

Point = tuple[float, float]


@dataclass(frozen=True)
class TargetRun:
    """A place in one run that has driven to it.

    Attributes:
        place: its name.
        run: the run.
        mapped: where the map has it, (x, y), metres.
        true: where it really is.
        targets: where legs to it were to end: as on the map, and after each update.
    """

    place: str
    run: Run
    mapped: Point
    true: Point
    targets: tuple[Point, ...]

    @property
    def distances(self) -> tuple[float, ...]:
        """Of each of the targets to the true place, metres."""
        return tuple(math.dist(target, self.true) for target in self.targets)

    @property
    def updates_until_gone(self) -> int | None:
        """How often the target had been moved when the mismatch was gone for good; None while it is not."""
        return updates_until_gone(self.entries)

    @property
    def entries(self) -> list[dict[str, Any]]:
        """What the episodes tell of the place, in its order."""
        return [entry for record in self.run.episodes for entry in _of_place(record, self.place)]

    def deliveries(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """(done, tried) of the episodes that led to the place before the mismatch was gone for good, and after.

        An episode in which it went is one before; where it never went, all are.
        """
        episodes = [record for record in self.run.episodes if _of_place(record, self.place)]
        learned = len(episodes)
        if self.updates_until_gone is not None:
            while learned and not any(map(is_mismatch, _of_place(episodes[learned - 1], self.place))):
                learned -= 1
        before, after = episodes[:learned], episodes[learned:]
        return _done(before), _done(after)


def target_runs(results: Results, ward: Ward, condition: str) -> tuple[TargetRun, ...]:
    """Every displaced place that a run under a condition has driven to, the paper's places first."""
    found = []
    for run in results.of(condition):
        true = _true_ward(results, run, ward)
        entries = [entry for record in run.episodes for entry in record.displaced_legs]
        for place in sorted({str(entry["place"]) for entry in entries}):
            if true is None or place not in ward.place:
                continue
            mapped = ward.place[place]
            moved = [entry for entry in entries if entry["place"] == place and entry["moved"]]
            targets = ((mapped.x, mapped.y), *((float(entry["x"]), float(entry["y"])) for entry in moved))
            where = true.place[place]
            found.append(TargetRun(place, run, (mapped.x, mapped.y), (where.x, where.y), targets))
    return tuple(sorted(found, key=lambda each: (_rank(each.place), each.run.profile, each.run.seed)))


def has_targets(results: Results) -> bool:
    """Whether places were displaced in any run."""
    return any(record.displaced_legs for run in results.runs for record in run.episodes)


def places_of(targets: Sequence[TargetRun]) -> tuple[str, ...]:
    """The places, each once."""
    return tuple(dict.fromkeys(each.place for each in targets))


def _rank(place: str) -> tuple[int, str]:
    names = list(PAPER_TARGET_UPDATES)
    return (names.index(place) if place in names else len(names), place)


def _true_ward(results: Results, run: Run, ward: Ward) -> Ward | None:
    """The ward of a run as it really was; None where the folder does not tell it."""
    told = dict(results.scenarios.get(run.condition, {}))
    told.pop("patient", None)  # May be one that no scenario can have; the ward does not depend on it.
    if not told:
        return None
    try:
        scenario = typed(Scenario, told, where="scenario", defaults=Scenario())
        scenario.random_seed = run.seed
        return scenario.true_ward(ward)
    except BadInput:
        return None


def _of_place(record: EpisodeRecord, place: str) -> list[dict[str, Any]]:
    return [entry for entry in record.displaced_legs if entry["place"] == place]


def _done(episodes: Sequence[EpisodeRecord]) -> tuple[int, int]:
    return sum(record.success for record in episodes), len(episodes)
