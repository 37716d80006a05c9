"""The unit of work of an experiment: one episode, wherever it is computed."""

from __future__ import annotations

import gc
import threading
from dataclasses import dataclass

from mala_drake.experiments.episode import Carried, simulate_episode
from mala_drake.experiments.stations import Stations
from mala_drake.fingerprint import fingerprint
from mala_drake.scenario import Scenario


@dataclass(frozen=True)
class EpisodeWork:
    """Everything that an episode depends on; `code` is the fingerprint of what is to compute it."""

    scenario: Scenario
    episode: int
    carried: Carried
    code: str


_one_at_a_time = threading.Lock()
_newest: Stations | None = None


def compute_episode(work: EpisodeWork) -> tuple[str, Carried]:
    """The record of the episode as a line of JSON, and what goes on from it.

    The newest run's stations are kept, because the next episode is likely to be of the same run, and to build one takes
    a second. A process computes one episode at a time: its threads could not go on side by side anyway.

    Raises:
        RuntimeError: this process has other code than the one that asks for the episode, for it is on another machine,
            or files were changed meanwhile.
    """
    here = fingerprint(work.scenario.ward)
    if work.code != here:
        raise RuntimeError(f"other code or models here (fingerprint {here}) than it was begun with")
    with _one_at_a_time:
        station = _stations(work.scenario).of_episode(work.episode)
        record, carried = simulate_episode(station, work.scenario, episode=work.episode, carried=work.carried)
        return record.to_json(), carried


def _stations(scenario: Scenario) -> Stations:
    global _newest
    if _newest is None or _newest.scenario != scenario:
        _newest = None
        gc.collect()  # A diagram is a knot of references, and a large one.
        _newest = Stations(scenario)
    return _newest
