"""Where the time of an episode goes: the physics, the MPC, planning, and the other systems.

The whole station is simulated under Python's profiler, which counts the CPU time of this process. What no Python code
has taken is compiled: the plant's steps, contact and kinematics. The profiler itself slows Python code down, so the
compiled share is a little larger without it; how much, the two rows of the whole episode tell.
"""

from __future__ import annotations

import cProfile
import pstats
import time
from pathlib import Path
from typing import Any

from mala_drake.experiments.episode import Carried, simulate_episode
from mala_drake.scenario import Scenario
from mala_drake.station import MakeCareStation

_PARTS = {
    "control": "MPC",
    "planning": "planning",
    "robot": "the robot's and the ward's systems",
    "grounding": "grounding, learning, patient, scheduling",
    "learning": "grounding, learning, patient, scheduling",
    "patient": "grounding, learning, patient, scheduling",
    "scheduling": "grounding, learning, patient, scheduling",
}
"""By the folder of the code that the simulator calls; what it calls in turn counts for it."""

_OTHER = "records"
_COMPILED = "physics (compiled)"
_PACKAGE = Path(__file__).parents[1]


def bench_episode(
    *, tasks: tuple[str, ...] = ("medication", "meal"), time_limit: float = 900.0
) -> list[dict[str, Any]]:
    """Rows with the CPU time of each part of an episode, for each task.

    Args:
        tasks: of the episodes.
        time_limit: seconds of simulation after which an episode ends in any case.
    """
    return [row for task in tasks for row in _measure(Scenario(task=task, episodes=1, episode_time_limit=time_limit))]


def _measure(scenario: Scenario) -> list[dict[str, Any]]:
    station = MakeCareStation(scenario)
    started = time.process_time()
    simulate_episode(station, scenario, episode=0, carried=Carried())
    undisturbed = time.process_time() - started
    profile = cProfile.Profile(time.process_time, builtins=False)
    record, _ = profile.runcall(simulate_episode, station, scenario, episode=0, carried=Carried())
    parts = _parts(pstats.Stats(profile))
    whole = sum(parts.values())
    rows = [
        ("whole episode, without the profiler", undisturbed),
        ("whole episode", whole),
        *sorted(parts.items(), key=lambda item: -item[1]),
    ]
    return [
        {
            "task": scenario.task,
            "part": part,
            "cpu_s": seconds,
            "share": seconds / whole,
            "ms_per_simulated_s": 1e3 * seconds / record.sim_time_s,
        }
        for part, seconds in rows
    ]


def _parts(stats: Any) -> dict[str, float]:
    """CPU seconds by part, of everything that is called from `simulate_episode` and not by way of other Python code."""
    (episode,) = [key for key in stats.stats if key[2] == simulate_episode.__name__]
    parts = {_COMPILED: stats.stats[episode][2]}  # Its own time: nothing of it is spent in Python but a short loop.
    for (file, _, _), (_, _, _, _, callers) in stats.stats.items():
        if episode in callers:
            part = _part(Path(file))
            parts[part] = parts.get(part, 0.0) + callers[episode][3]
    return parts


def _part(file: Path) -> str:
    inside = file.relative_to(_PACKAGE).parts[0] if file.is_relative_to(_PACKAGE) else ""
    return _PARTS.get(inside, _OTHER)
