"""Conducting runs side by side: whatever ends first, and wherever one fails, the files are those of runs alone."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import conduct as mut
from mala_drake.experiments.executors.abstract_executor import AbstractExecutor, Finished
from mala_drake.experiments.executors.serial import SerialExecutor
from mala_drake.experiments.experiment import Experiment, RunName
from mala_drake.scenario import Scenario

EPISODES = 3
EXPERIMENT = Experiment(
    name="convergence",
    base=Scenario(episodes=EPISODES),
    conditions={"": {"learner": {"name": "posterior"}}, "fixed": {"learner": {"name": "fixed"}}},
    profiles=("speed_oriented", "safety_first"),
    seeds=(0, 7),
)


class ScrambledExecutor(AbstractExecutor):
    """Has room for several calls, and finishes them in any order."""

    def __init__(self, function, *, capacity, seed):
        self._function, self._capacity = function, capacity
        self._random = random.Random(seed)
        self._under_way = {}
        self.most = 0

    @property
    def capacity(self):
        return self._capacity

    def submit(self, key, argument):
        assert key not in self._under_way
        assert len(self._under_way) < self._capacity
        self._under_way[key] = argument
        self.most = max(self.most, len(self._under_way))

    def next_finished(self):
        key = self._random.choice(list(self._under_way))
        try:
            return Finished(key, self._function(self._under_way.pop(key)))
        except ValueError as error:
            return Finished(key, error=str(error))

    def close(self):
        self._under_way.clear()


class Notes:
    def __init__(self):
        self.started, self.episodes, self.runs, self.failures = None, [], {}, {}
        self.earlier = {}

    def on_start(self, *, runs, episodes, done):
        self.started = runs, episodes, done

    def on_episode(self, run, episode):
        self.episodes.append((run, episode))

    def on_run(self, run, records, *, earlier_episodes):
        self.runs[run], self.earlier[run] = records, earlier_episodes

    def on_failure(self, run, error):
        self.failures[run] = error


def content(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*.json*"))}


@pytest.fixture
def expected(tmp_path_factory, fake_episode):
    folder = tmp_path_factory.mktemp("serial")
    mut.conduct(EXPERIMENT, folder, SerialExecutor(fake_episode), watcher=Notes())
    return content(folder)


@pytest.mark.parametrize(("capacity", "seed"), [(1, 0), (2, 1), (3, 2), (20, 3)])
def test_results_do_not_depend_on_how_many_run_at_a_time_or_who_ends_first(
    tmp_path, fake_episode, expected, capacity, seed
):
    executor = ScrambledExecutor(fake_episode, capacity=capacity, seed=seed)
    assert mut.conduct(EXPERIMENT, tmp_path, executor, watcher=Notes()) == {}
    assert executor.most == min(capacity, len(EXPERIMENT.runs))
    assert content(tmp_path) == expected


def test_every_run_is_the_one_that_runs_alone(expected, whole_run):
    for run in EXPERIMENT.runs:
        lines = expected[run.folder / "episodes.jsonl"].decode().splitlines()
        assert lines == whole_run(EXPERIMENT.scenario(run), EPISODES)[0]
    assert len({expected[run.folder / "episodes.jsonl"] for run in EXPERIMENT.runs}) == len(EXPERIMENT.runs) == 8


def test_the_watcher_is_told_each_episode_and_each_run_once(tmp_path, fake_episode):
    notes = Notes()
    mut.conduct(EXPERIMENT, tmp_path, ScrambledExecutor(fake_episode, capacity=3, seed=0), watcher=notes)
    assert notes.started == (8, 24, 0)
    assert sorted(notes.episodes, key=str) == sorted(
        ((run, episode) for run in EXPERIMENT.runs for episode in range(EPISODES)), key=str
    )
    assert {run: [record.episode for record in records] for run, records in notes.runs.items()} == {
        run: [0, 1, 2] for run in EXPERIMENT.runs
    }
    assert notes.failures == {}


def test_the_watcher_is_told_how_many_episodes_came_before_a_change_of_mind(tmp_path, fake_episode):
    drift = {"patient": {"earlier_weights": [0.2] * 5, "earlier_episodes": 2}}
    experiment = replace(EXPERIMENT, conditions={"full": {}, "drift": drift}, profiles=("safety_first",), seeds=(0,))
    notes = Notes()
    mut.conduct(experiment, tmp_path, SerialExecutor(fake_episode), watcher=notes)
    assert {run.condition: earlier for run, earlier in notes.earlier.items()} == {"full": 0, "drift": 2}


BAD = RunName("", "safety_first", 7)


def test_a_run_that_fails_is_told_the_others_end_and_it_can_be_gone_on_with(tmp_path, fake_episode, expected):
    def failing(work):
        scenario = work.scenario
        if (scenario.learner.name, scenario.profile_name, scenario.random_seed, work.episode) == (
            "posterior",
            BAD.profile,
            BAD.seed,
            1,
        ):
            raise ValueError("the roof fell in")
        return fake_episode(work)

    notes = Notes()
    failures = mut.conduct(EXPERIMENT, tmp_path, ScrambledExecutor(failing, capacity=3, seed=0), watcher=notes)
    assert failures == notes.failures == {BAD: "episode 2: the roof fell in"}
    assert set(notes.runs) == set(EXPERIMENT.runs) - {BAD}
    assert (tmp_path / BAD.folder / "episodes.jsonl").read_bytes().count(b"\n") == 1

    notes = Notes()
    assert mut.conduct(EXPERIMENT, tmp_path, SerialExecutor(fake_episode), watcher=notes) == {}
    assert notes.started == (8, 24, 22)
    assert notes.episodes == [(BAD, 1), (BAD, 2)]
    assert content(tmp_path) == expected


@pytest.mark.parametrize("after", [0, 1, 5, 23])
def test_an_interrupted_experiment_goes_on_where_it_was(tmp_path, fake_episode, expected, after):
    class Impatient(Notes):
        def on_episode(self, run, episode):
            super().on_episode(run, episode)
            if len(self.episodes) > after:
                raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        mut.conduct(EXPERIMENT, tmp_path, ScrambledExecutor(fake_episode, capacity=3, seed=after), watcher=Impatient())
    notes = Notes()
    mut.conduct(EXPERIMENT, tmp_path, ScrambledExecutor(fake_episode, capacity=2, seed=1), watcher=notes)
    assert notes.started == (8, 24, after + 1)
    assert content(tmp_path) == expected


def test_a_run_whose_files_cannot_be_written_is_told_in_one_line(tmp_path, fake_episode):
    (tmp_path / "speed_oriented").write_text("no folder")
    with pytest.raises(BadInput, match="speed_oriented"):
        mut.conduct(EXPERIMENT, tmp_path, SerialExecutor(fake_episode), watcher=Notes())
