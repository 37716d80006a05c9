"""Episodes that nobody had to simulate, and executors that nothing is quick enough for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import mala_drake
from mala_drake.experiments.compute_episode import EpisodeWork
from mala_drake.experiments.episode import Carried
from mala_drake.experiments.episode_record import EpisodeRecord, by_criterion, timing
from mala_drake.learning.convergence import preference_distance
from mala_drake.randomness import keyed_generator
from mala_drake.scenario import Scenario


def _episode_record(**changes) -> EpisodeRecord:
    values = {
        "episode": 0,
        "task": "medication",
        "profile": "speed_oriented",
        "seed": 0,
        "success": True,
        "failure": None,
        "actions": ["(go robot1)"],
        "plan_variant": "north/A/med-supp/left",
        "plan_cost": 0.5,
        "replans": 8,
        "features": by_criterion([0.5] * 5),
        "predicted_features": by_criterion([0.4] * 5),
        "ratings": [4.0] * 5,
        "weights_before": [0.2] * 5,
        "weights_after": [0.2] * 5,
        "weights_std": None,
        "distance_to_true": 0.3,
        "sim_time_s": 90.0,
        "solver": "snopt",
        "mpc_solves": 10,
        "mpc_failures": 0,
        "mpc_not_converged": 0,
        "min_clearance_m": 0.2,
        "collisions": 0,
        "terminal_errors_m": [0.01],
        "terminal_yaw_errors_rad": [0.02],
        "terminal_speeds_m_s": [0.03],
        "leg_outcomes": ["success"],
        "mismatches": 0,
        "battery_start": 1.0,
        "battery_end": 0.4,
        "timing": timing(wall_seconds=1.0, cpu_seconds=0.5, mpc_seconds=[0.002], plan_seconds=[0.01]),
    }
    return EpisodeRecord(**{**values, **changes})


def _fake_episode(work: EpisodeWork) -> tuple[str, Carried]:
    """A record that depends on everything an episode may depend on, through numbers that no rounding would forgive."""
    scenario = work.scenario
    generator = keyed_generator(scenario.random_seed, work.episode, scenario.profile_name + scenario.learner.name)
    before = np.array((work.carried.learners or {"preference_learner": (0.2,) * 5})["preference_learner"])
    weights = before + 0.3 * generator.random() * (np.array(scenario.true_weights) - before) + 1e-17
    record = _episode_record(
        episode=work.episode,
        profile=scenario.profile_name,
        seed=scenario.random_seed,
        features=by_criterion(generator.random(5)),
        weights_before=list(before),
        weights_after=list(weights),
        distance_to_true=preference_distance(weights, scenario.true_weights),
        sim_time_s=float(generator.normal(90.0, 5.0)),
        timing={"wall_s": generator.random(), "cpu_s": 0.5, "mpc_median_ms": 2.0},
    )
    return record.to_json(), Carried(work.carried.ticks + 1 + work.episode, {"preference_learner": tuple(weights)})


@pytest.fixture
def episode_record() -> Callable[..., EpisodeRecord]:
    """Makes a record; arguments change its fields."""
    return _episode_record


@pytest.fixture(scope="session")
def fake_episode() -> Callable[[EpisodeWork], tuple[str, Carried]]:
    """Stands in for `compute_episode`."""
    return _fake_episode


@pytest.fixture(scope="session")
def whole_run() -> Callable[..., tuple[list[str], list[Carried]]]:
    """The lines of a run that nothing has disturbed, and what is carried on after 0, 1, ... episodes."""

    def run(scenario: Scenario, episodes: int) -> tuple[list[str], list[Carried]]:
        lines, carried = [], [Carried()]
        for episode in range(episodes):
            line, after = _fake_episode(EpisodeWork(scenario, episode, carried[-1], code=""))
            lines.append(line)
            carried.append(after)
        return lines, carried

    return run


@pytest.fixture(scope="session")
def dask_address() -> Iterator[str]:
    """The address of a scheduler with two workers, which import this very tree."""
    distributed = pytest.importorskip("distributed")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(Path(mala_drake.__file__).parents[1]))
        cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0")
    with cluster:
        yield cluster.scheduler_address
