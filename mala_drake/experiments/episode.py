"""One episode of a run, in a fresh context of a station that is kept, and what goes on from it to the next."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Diagram

from mala_drake.clock import TICK
from mala_drake.errors import BadInput
from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.experiments.episode_watch import EpisodeWatch
from mala_drake.scenario import Scenario
from mala_drake.station_context import SleepingBoxesOf, StartEpisode, learner_states_of


@dataclass(frozen=True, slots=True)
class Carried:
    """What goes on from one episode to the next: a few numbers, so a run can be stopped and continued after any.

    Attributes:
        ticks: of the simulation's clock at which the next episode begins.
        learners: what each learner has learned, by the name of its system; None at the beginning.
    """

    ticks: int = 0
    learners: Mapping[str, tuple[float, ...]] | None = None

    @property
    def seconds(self) -> float:
        """The time on the simulation's clock."""
        return self.ticks * TICK

    def to_json(self) -> dict[str, Any]:
        """As JSON can hold it: every number is written such that it is read back bit for bit."""
        learners = None if self.learners is None else {name: list(state) for name, state in self.learners.items()}
        return {"ticks": self.ticks, "learners": learners}

    @staticmethod
    def from_json(data: Any, *, where: str) -> Carried:
        """What `to_json` was called on.

        Raises:
            BadInput: if `data` is not of that form.
        """
        try:
            learners = data["learners"]
            if learners is not None:
                learners = {str(name): tuple(map(float, state)) for name, state in learners.items()}
            return Carried(int(data["ticks"]), learners)
        except (AttributeError, KeyError, TypeError, ValueError):
            raise BadInput(where, repr(data), "ticks and the learners' numbers") from None


def simulate_episode(
    station: Diagram,
    scenario: Scenario,
    *,
    episode: int,
    carried: Carried,
    realtime_rate: float = 0.0,
    on_action: Callable[[float, str], None] | None = None,
) -> tuple[EpisodeRecord, Carried]:
    """Simulates until the episode is rated and learned from, or its time is up.

    What happens depends on the scenario, the number of the episode and `carried` alone, not on what else has run on
    the station.

    Args:
        station: from `MakeCareStation(scenario)`.
        scenario: that is simulated.
        episode: its number, from 0.
        carried: from the episode before; `Carried()` for the first one.
        realtime_rate: simulated seconds per wall second at most; 0 is as fast as possible.
        on_action: told the time on the simulation's clock, in seconds, and what the robot begins then.
    """
    wall, cpu = time.perf_counter(), time.process_time()
    context = station.CreateDefaultContext()
    learners = None if carried.learners is None else {n: np.array(state) for n, state in carried.learners.items()}
    StartEpisode(station, context, episode=episode, time=carried.seconds, learner_states=learners)
    simulator = Simulator(station, context)
    simulator.set_target_realtime_rate(realtime_rate)
    simulator.Initialize()
    watch, boxes = EpisodeWatch(station, context, scenario, episode), SleepingBoxesOf(station, context)
    ticks = carried.ticks
    limit = ticks + round(scenario.episode_time_limit / TICK)
    while not watch.finished and ticks < limit:
        ticks += 1  # The watch looks at the ports each tick: every report is seen.
        boxes.update()
        simulator.AdvanceTo(ticks * TICK)
        for text in watch.look():
            if on_action:
                on_action(context.get_time(), text)
    states = {name: tuple(map(float, state)) for name, state in learner_states_of(station, context).items()}
    record = watch.record(wall_seconds=time.perf_counter() - wall, cpu_seconds=time.process_time() - cpu)
    return record, Carried(ticks, states)
