"""An episode depends on its scenario, its number and what is carried: not on what a process has computed before."""

from __future__ import annotations

import json
import pickle

import pytest

from mala_drake.experiments import compute_episode as mut
from mala_drake.experiments.episode import Carried
from mala_drake.fingerprint import fingerprint
from mala_drake.resources import models_folder
from mala_drake.scenario import Scenario


def scenario(**changes):
    """Long enough to plan, to turn and to drive; the episode fails for lack of time."""
    return Scenario(episodes=3, task="alternate", episode_time_limit=3.0, **changes)


def without_timing(line):
    return {key: value for key, value in json.loads(line).items() if key != "timing"}


@pytest.fixture(scope="module")
def in_a_row():
    """A medication round, a meal and a medication round, each with what was carried into it and out of it."""
    work, done = [], []
    carried = Carried()
    for episode in range(3):
        work.append(mut.EpisodeWork(scenario(random_seed=2), episode, carried, fingerprint()))
        line, carried = mut.compute_episode(work[-1])
        done.append((line, carried))
    return work, done


def test_the_clock_and_what_was_learned_go_on(in_a_row):
    _, done = in_a_row
    assert [carried.ticks for _, carried in done] == [15, 30, 45]
    assert all(list(carried.learners) == ["preference_learner", "cost_learner"] for _, carried in done)
    assert [json.loads(line)["episode"] for line, _ in done] == [0, 1, 2]
    assert [json.loads(line)["task"] for line, _ in done] == ["medication", "meal", "medication"]


def test_the_stations_of_a_run_are_kept_for_its_next_episodes(in_a_row):
    works, _ = in_a_row
    kept = mut._newest
    mut.compute_episode(works[0])
    assert mut._newest is kept


def test_an_episode_is_the_same_in_another_process_that_has_just_computed_something_else(in_a_row):
    works, done = in_a_row
    elsewhere = pickle.loads(pickle.dumps(works[2]))
    mut.compute_episode(mut.EpisodeWork(scenario(random_seed=5), 0, Carried(), fingerprint()))
    assert mut._newest.scenario != elsewhere.scenario  # So its station is built anew.
    line, carried = mut.compute_episode(elsewhere)
    assert without_timing(line) == without_timing(done[2][0])
    assert carried == done[2][1]


def test_other_code_than_it_was_begun_with_does_not_compute_it():
    work = mut.EpisodeWork(scenario(), 0, Carried(), code="0123456789abcdef")
    with pytest.raises(RuntimeError, match="other code or models here"):
        mut.compute_episode(work)


def test_another_ward_map_of_ones_own_than_it_was_begun_with_does_not_compute_it(tmp_path):
    ward = tmp_path / "own.ward.yaml"
    ward.write_bytes((models_folder() / "care_center.ward.yaml").read_bytes())
    work = mut.EpisodeWork(scenario(ward=str(ward)), 0, Carried(), fingerprint(str(ward)))
    ward.write_text(ward.read_text() + "\n# Changed meanwhile.\n")
    with pytest.raises(RuntimeError, match="other code or models here"):
        mut.compute_episode(work)
