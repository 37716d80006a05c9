"""Experiments from the command line to the disk: in real processes, on the physics, interrupted and gone on with."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import mala_drake
from mala_drake.errors import BadInput
from mala_drake.experiments import experiments as mut
from mala_drake.experiments.ablations import ABLATION_KIND
from mala_drake.experiments.convergence import CONVERGENCE
from mala_drake.experiments.experiment_kind import ExperimentOptions
from mala_drake.reporting.experiment_console import ExperimentConsole

SHORT = "{task: medication, episode_time_limit: 1.0}"
"""Episodes that fail for lack of time: cheap, and as deterministic as any."""

SEEDS = (0, 1, 2)
"""One more than processes: to build the station for the third takes longer than to notice the first line of results."""


class Nobody:
    def on_nothing_begun(self, folder):
        pass

    def on_start(self, **numbers):
        pass

    def on_episode(self, run, episode):
        pass

    def on_run(self, run, records, *, earlier_episodes):
        pass

    def on_failure(self, run, error):
        pass


def start(folder, *arguments):
    """The command line in a process group of its own, as a terminal starts it."""
    return subprocess.Popen(
        [sys.executable, "-m", "mala_drake", "experiment", *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(Path(mala_drake.__file__).parents[1])},
        start_new_session=True,
    )


def lines_in(folder):
    return sum(path.read_bytes().count(b"\n") for path in folder.rglob("episodes.jsonl"))


def wait_for_lines(process, folder, count):
    while process.poll() is None and lines_in(folder) < count:
        time.sleep(0.01)


def results(folder):
    """Everything there is, without what depends on the machine."""
    found = {}
    for path in sorted(folder.rglob("*.json*")):
        data = [json.loads(line) for line in path.read_text().splitlines()] if path.suffix == ".jsonl" else []
        data = data or [json.loads(path.read_text() or "null")]
        found[path.relative_to(folder)] = [
            {key: value for key, value in each.items() if key != "timing"} for each in data
        ]
    return found


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Three runs of two short episodes, one after another in this process."""
    folder = tmp_path_factory.mktemp("alone")
    (folder / "short.yaml").write_text(SHORT)
    options = ExperimentOptions(scenario=folder / "short.yaml", profiles=("safety_first",), seeds=SEEDS, episodes=2)
    out = folder / "results"
    summary = mut.run_experiment(CONVERGENCE, options, mut.Execution(out=out, executor="serial"), watcher=Nobody())
    return folder, summary


def test_the_files_are_the_agreed_ones(alone):
    folder, summary = alone
    out = folder / "results"
    for seed in SEEDS:
        lines = (out / "safety_first" / f"seed_{seed}" / "episodes.jsonl").read_text().splitlines()
        assert [(json.loads(line)["episode"], json.loads(line)["seed"]) for line in lines] == [(0, seed), (1, seed)]
    assert json.loads((out / "summary.json").read_text()) == summary
    agreed = {"convergence_episode", "best_distance", "final_distance", "success_rate", "plan_variants"}
    assert agreed <= set(summary["profiles"]["safety_first"])
    assert mut.files_of(CONVERGENCE, out) == [out / "summary.json"]


def test_interrupted_by_the_keyboard_and_gone_on_with_in_two_processes_it_comes_to_the_same(alone, tmp_path):
    folder, _ = alone
    seeds = ",".join(map(str, SEEDS))
    asked = ["convergence", folder / "short.yaml", "--profiles", "safety_first", "--seeds", seeds, "--episodes", 2]
    first = start(tmp_path, *asked, "--out", "results", "--jobs", 2)
    wait_for_lines(first, tmp_path, 1)
    os.killpg(first.pid, signal.SIGINT)  # A terminal sends it to all of them.
    output, errors = first.communicate(timeout=120)
    assert (first.returncode, output) == (130, "")
    assert errors.splitlines()[-1] == "mala-drake: interrupted; what was written before stays"
    assert "Traceback" not in errors
    assert lines_in(tmp_path) >= 1

    second = start(tmp_path, "convergence", "--out", "results", "--resume", "--jobs", 2, "--json")
    output, errors = second.communicate(timeout=120)
    assert second.returncode == 1, errors  # Because the episodes fail.
    assert json.loads(output) == json.loads((tmp_path / "results" / "summary.json").read_text())
    assert results(tmp_path / "results") == results(folder / "results")


def test_on_a_dask_cluster_it_comes_to_the_same(alone, tmp_path, dask_address):
    folder, _ = alone
    options = ExperimentOptions(scenario=folder / "short.yaml", profiles=("safety_first",), seeds=SEEDS, episodes=2)
    execution = mut.Execution(out=tmp_path, executor="dask", address=dask_address)
    mut.run_experiment(CONVERGENCE, options, execution, watcher=Nobody())
    assert results(tmp_path) == results(folder / "results")


@pytest.mark.parametrize(
    ("kind", "changes", "words"),
    [
        (CONVERGENCE, {"episodes": 3}, r"scenario\.episodes: 3; expected 2"),
        (CONVERGENCE, {"seeds": (0,)}, r"seeds"),
        (CONVERGENCE, {"conditions": ("fixed",)}, r"learner\.name"),
        (ABLATION_KIND, {}, r"experiment: ablations; expected convergence"),
    ],
)
def test_to_go_on_with_another_experiment_is_refused(alone, kind, changes, words):
    folder, _ = alone
    before = results(folder / "results")
    with pytest.raises(BadInput, match=words):
        mut.run_experiment(
            kind,
            ExperimentOptions(**changes),
            mut.Execution(out=folder / "results", resume=True, executor="serial"),
            watcher=Nobody(),
        )
    assert results(folder / "results") == before


def test_to_go_on_where_nothing_was_begun_is_told_and_begins(tmp_path, capsys):
    (tmp_path / "short.yaml").write_text(SHORT)
    options = ExperimentOptions(scenario=tmp_path / "short.yaml", profiles=("safety_first",), seeds=(0,), episodes=1)
    execution = mut.Execution(out=tmp_path / "results", resume=True, executor="serial")
    for told in (True, False):  # The second time there is something.
        with ExperimentConsole(quiet=False) as console:
            mut.run_experiment(CONVERGENCE, options, execution, watcher=console)
        line = f"nothing was begun in {tmp_path / 'results'}: the experiment begins anew"
        assert (line in capsys.readouterr().err.splitlines()) == told


def test_ablations_have_a_page_of_their_own(tmp_path):
    (tmp_path / "short.yaml").write_text(SHORT)
    options = ExperimentOptions(
        scenario=tmp_path / "short.yaml",
        profiles=("safety_first",),
        seeds=(0,),
        episodes=1,
        conditions=("full", "crisp_grounding"),
    )
    out = tmp_path / "results"
    summary = mut.run_experiment(ABLATION_KIND, options, mut.Execution(out=out, executor="serial"), watcher=Nobody())
    assert list(summary["conditions"]) == ["full", "crisp_grounding"]
    assert (out / "crisp_grounding" / "safety_first" / "seed_0" / "episodes.jsonl").is_file()
    assert mut.files_of(ABLATION_KIND, out) == [out / "summary.json", out / "ablations.md"]
    assert "crisp grounding" in (out / "ablations.md").read_text()


def test_a_summary_that_cannot_be_written_is_told_in_one_line_and_leaves_the_episodes(tmp_path):
    (tmp_path / "short.yaml").write_text(SHORT)
    options = ExperimentOptions(scenario=tmp_path / "short.yaml", profiles=("safety_first",), seeds=(0,), episodes=1)
    out = tmp_path / "results"

    class Meddler(Nobody):
        def on_start(self, **numbers):
            (out / "summary.json.new").mkdir()

    with pytest.raises(BadInput, match=r"summary\.json: cannot be written"):
        mut.run_experiment(CONVERGENCE, options, mut.Execution(out=out, executor="serial"), watcher=Meddler())
    assert lines_in(out) == 1


@pytest.mark.slow
def test_killed_again_and_again_it_comes_to_the_same_as_never_killed(tmp_path):
    """Whole episodes of both tasks on the physics, delivered and learned from."""
    asked = ["convergence", "--profiles", "speed_oriented,presentation_focused", "--seeds", 0, "--episodes", 3]
    asked += ["--solver", "rti"]
    process = start(tmp_path, *asked, "--out", "killed", "--jobs", 2)
    ends = []
    for kill in range(4):
        # Somewhere in the middle of an episode: at another place each time.
        wait_for_lines(process, tmp_path / "killed", lines_in(tmp_path / "killed") + 1)
        time.sleep(0.7 * kill)
        process.kill()  # Or not, if a fast machine was through before.
        process.communicate()
        ends.append(process.returncode)
        process = start(tmp_path, *asked, "--out", "killed", "--resume", "--jobs", 1 + kill % 2)
    process.communicate()
    assert process.returncode == 0
    assert ends[:2] == [-signal.SIGKILL] * 2

    undisturbed = start(tmp_path, *asked, "--out", "undisturbed", "--jobs", 1)
    undisturbed.communicate()
    assert undisturbed.returncode == 0
    assert results(tmp_path / "killed") == results(tmp_path / "undisturbed")
    summary = json.loads((tmp_path / "killed" / "summary.json").read_text())
    assert (summary["totals"]["episodes"], summary["totals"]["successes"]) == (6, 6)
    assert summary["totals"]["collisions"] == 0
