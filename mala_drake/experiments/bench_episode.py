"""Where the time of an episode goes: the physics, the MPC, planning, and the other systems.

The whole station is simulated under a profiler that counts the processor time of the simulating thread. What no Python
code has taken is compiled: the plant's steps, contact and kinematics. The profiler itself slows Python code down, so
the compiled share is a little larger without it; how much, the two rows of the whole episode tell.
"""

from __future__ import annotations

import time
from functools import partial
from pathlib import Path
from typing import Any

from mala_drake.experiments.callee_times import CalleeTimes, time_callees
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

    Raises:
        BadInput: if this thread is being profiled already.
    """
    return [row for task in tasks for row in _measure(Scenario(task=task, episodes=1, episode_time_limit=time_limit))]


def _measure(scenario: Scenario) -> list[dict[str, Any]]:
    simulate = partial(simulate_episode, MakeCareStation(scenario), scenario, episode=0, carried=Carried())
    started = time.thread_time()
    simulate()
    undisturbed = time.thread_time() - started
    (record, _), times = time_callees(simulate)
    parts = _parts(times)
    rows = [
        ("whole episode, without the profiler", undisturbed),
        ("whole episode", times.whole),
        *sorted(parts.items(), key=lambda item: -item[1]),
    ]
    return [
        {
            "task": scenario.task,
            "part": part,
            "cpu_s": seconds,
            "share": seconds / times.whole,
            "ms_per_simulated_s": 1e3 * seconds / record.sim_time_s,
        }
        for part, seconds in rows
    ]


def _parts(times: CalleeTimes) -> dict[str, float]:
    """Seconds by part; what the episode has not spent in its callees is compiled, but for a short loop of its own."""
    parts = {_COMPILED: times.whole - sum(times.by_file.values())}
    for file, seconds in times.by_file.items():
        part = _part(Path(file))
        parts[part] = parts.get(part, 0.0) + seconds
    return parts


def _part(file: Path) -> str:
    inside = file.relative_to(_PACKAGE).parts[0] if file.is_relative_to(_PACKAGE) else ""
    return _PARTS.get(inside, _OTHER)
