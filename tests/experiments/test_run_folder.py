"""A run's folder: wherever a process is killed, no finished episode is lost and none is written twice."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.experiments import run_folder as mut
from mala_drake.experiments.compute_episode import EpisodeWork
from mala_drake.experiments.episode import Carried
from mala_drake.scenario import Scenario

EPISODES = 4
SCENARIO = Scenario(random_seed=3)


class Killed(BaseException):
    """What no code that is killed can catch."""


class DyingSystem:
    """The operating system of a process that is killed at its n-th call, of whose last write a part may be done."""

    def __init__(self, calls, share):
        self._calls, self._share = calls, share

    def __getattr__(self, name):
        real = getattr(os, name)
        if name not in ("write", "replace", "fsync", "ftruncate"):
            return real

        def call(*arguments):
            self._calls -= 1
            if self._calls > 0:
                return real(*arguments)
            if name == "write":
                descriptor, data = arguments
                real(descriptor, data[: int(self._share * len(data))])
            raise Killed

        return call


def go_on(path, fake_episode):
    """What a conductor does: brings the run from where it is to its end."""
    with mut.RunFolder(path) as files:
        while files.episodes < EPISODES:
            files.append(*fake_episode(EpisodeWork(SCENARIO, files.episodes, files.carried, code="")))


def content(path):
    return (path / "episodes.jsonl").read_text().splitlines()


@settings(max_examples=30)
@given(st.lists(st.tuples(st.integers(1, 60), st.floats(0.0, 1.0)), max_size=6))
def test_a_run_that_is_killed_anywhere_and_gone_on_with_is_the_undisturbed_run(fake_episode, whole_run, kills):
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        finished = 0
        for calls, share in kills:
            system = DyingSystem(calls, share)
            patch.setattr("mala_drake.experiments.run_folder.os", system)
            patch.setattr("mala_drake.experiments.durable_files.os", system)
            try:
                go_on(Path(folder), fake_episode)
            except Killed:
                whole = (Path(folder) / "episodes.jsonl").read_bytes().count(b"\n")
                assert whole >= finished  # What was whole before stays.
                finished = whole
        patch.undo()
        go_on(Path(folder), fake_episode)
        assert content(Path(folder)) == whole_run(SCENARIO, EPISODES)[0]


def test_every_single_kill_is_survived(tmp_path, monkeypatch, fake_episode, whole_run):
    """The same without luck: a kill at each call of the operating system, until one comes too late."""
    for calls in range(1, 200):
        path = tmp_path / str(calls)
        with monkeypatch.context() as patch:
            system = DyingSystem(calls, 0.5)
            patch.setattr("mala_drake.experiments.run_folder.os", system)
            patch.setattr("mala_drake.experiments.durable_files.os", system)
            try:
                go_on(path, fake_episode)
                break
            except Killed:
                pass
        before = content(path)
        with mut.RunFolder(path) as files:
            # Nothing that was finished is done again.
            assert files.episodes == sum(line in before for line in whole_run(SCENARIO, EPISODES)[0])
        go_on(path, fake_episode)
        assert content(path) == whole_run(SCENARIO, EPISODES)[0]
    assert calls > 20


@pytest.fixture
def done(tmp_path, fake_episode):
    go_on(tmp_path, fake_episode)
    return tmp_path


def test_a_torn_last_line_is_cut_off(done, fake_episode, whole_run):
    lines = content(done)
    (done / "episodes.jsonl").write_text("\n".join(lines[:-1]) + "\n" + lines[-1][:40])
    with mut.RunFolder(done) as files:
        assert files.episodes == EPISODES - 1
        assert files.carried == whole_run(SCENARIO, EPISODES)[1][-2]
    assert content(done) == lines[:-1]


def test_episodes_that_the_checkpoint_does_not_know_are_done_again(done, fake_episode):
    lines = content(done)
    (done / "episodes.jsonl").write_text("\n".join([*lines, lines[0].replace('"episode": 0', '"episode": 4')]) + "\n")
    with mut.RunFolder(done) as files:
        assert files.episodes == EPISODES
    assert content(done) == lines


@pytest.mark.parametrize("kept", [0, 1, 2])
def test_a_run_whose_newest_states_are_beyond_its_episodes_begins_anew(done, fake_episode, kept):
    lines = content(done)
    (done / "episodes.jsonl").write_text("".join(line + "\n" for line in lines[:kept]))
    go_on(done, fake_episode)
    assert content(done) == lines


def test_episodes_without_a_checkpoint_are_done_again(done, fake_episode):
    lines = content(done)
    (done / "checkpoint.json").unlink()
    with mut.RunFolder(done) as files:
        assert (files.episodes, files.carried) == (0, Carried())
    go_on(done, fake_episode)
    assert content(done) == lines


def test_an_episode_out_of_its_order_and_all_behind_it_are_done_again(done, fake_episode):
    lines = content(done)
    (done / "episodes.jsonl").write_text("\n".join([lines[0], lines[2], lines[1], lines[3]]) + "\n")
    go_on(done, fake_episode)
    assert content(done) == lines


@pytest.mark.parametrize(
    "text", ["", "{", "[]", '{"carried_after": {"one": {}}}', '{"carried_after": {"1": {"ticks": 1}}}']
)
def test_what_is_no_checkpoint_is_told_in_one_line(done, text):
    (done / "checkpoint.json").write_text(text)
    with pytest.raises(BadInput, match=r"checkpoint\.json"):
        mut.RunFolder(done)


def test_a_folder_that_cannot_be_made_is_told_in_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="cannot be written"):
        mut.RunFolder(tmp_path / "file" / "run")


@pytest.mark.parametrize("calls", [1, 2])  # Of the checkpoint, and of the line.
def test_a_full_disk_is_told_in_one_line_and_loses_nothing(done, fake_episode, monkeypatch, calls):
    lines = content(done)
    (done / "episodes.jsonl").write_text("".join(line + "\n" for line in lines[:-1]))

    class Full(DyingSystem):
        def __getattr__(self, name):
            call = super().__getattr__(name)

            def told(*arguments):
                try:
                    return call(*arguments)
                except Killed:
                    raise OSError(28, "No space left on device") from None

            return told if name == "write" else getattr(os, name)

    files = mut.RunFolder(done)
    with monkeypatch.context() as patch:
        patch.setattr("mala_drake.experiments.durable_files.os", Full(calls, 0.3))
        with pytest.raises(BadInput, match="No space left"):
            files.append(*fake_episode(EpisodeWork(SCENARIO, files.episodes, files.carried, code="")))
    files.close()
    go_on(done, fake_episode)
    assert content(done) == lines


def test_the_checkpoint_is_numbers_alone(done):
    text = (done / "checkpoint.json").read_text()
    assert set(text) <= set('{}[]:,. "\n0123456789-e+' + "carried_after" + "ticks" + "learners" + "preference_learner")
