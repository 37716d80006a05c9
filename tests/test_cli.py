"""The command line: exit status, JSON and nothing else where asked for, and one line for each mistake."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import mala_drake
from mala_drake.resources import domains_folder

from .command_line import call, mistake

MEDICATION = [str(domains_folder() / "domain_med.pddl"), str(domains_folder() / "problem_med.pddl")]


def process(*arguments, folder, **environment):
    root = str(Path(mala_drake.__file__).parents[1])
    return subprocess.run(
        [sys.executable, "-m", "mala_drake", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": root, **environment},
    )


def test_the_version_is_told(capfd):
    assert call(capfd, "--version") == (0, f"mala-drake {mala_drake.__version__}\n", "")


@pytest.mark.parametrize("arguments", [[], ["--help"]])
def test_help_lists_the_commands(capfd, arguments):
    status, output, errors = call(capfd, *arguments)
    assert (status, errors) == (0, "")
    for name in ("run", "plan", "graph", "experiment", "bench"):
        assert name in output


@pytest.mark.parametrize("command", ["run", "plan", "graph", "experiment", "bench"])
def test_each_command_explains_itself(capfd, command):
    status, output, errors = call(capfd, command, "--help")
    assert (status, errors) == (0, "")
    assert command in output


def test_help_tells_the_usual_sizes_of_experiments(capfd):
    from mala_drake.experiments.experiments import EXPERIMENTS

    _, output, _ = call(capfd, "experiment", "--help")
    text = " ".join(output.replace("│", " ").split())
    kinds = EXPERIMENTS.values()
    for counts in (
        [f"{len(kind.size.profiles)} for {kind.name}" for kind in kinds],
        [f"{kind.size.episodes} for {kind.name}" for kind in kinds],
    ):
        assert f"left out: {', '.join(counts)}." in text
    assert {kind.size.seeds for kind in kinds} == {tuple(range(5))}
    assert "0-4, which is usual" in text
    full = EXPERIMENTS["ablations"].full_size
    assert f"all {len(full.profiles)} patients, and {full.episodes} episodes" in text


def test_help_does_not_import_drake(tmp_path):
    code = (
        "import sys; from mala_drake.cli import main\n"
        "try: main(['run', '--help'])\n"
        "except SystemExit: pass\n"
        "print(sorted({'pydrake', 'casadi', 'numpy', 'shapely', 'pddl', 'matplotlib'} & set(sys.modules)))"
    )
    root = str(Path(mala_drake.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": root}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["dance"], ["dance"]),
        (["--nonsense"], ["--nonsense"]),
        (["run", "--nonsense"], ["--nonsense", "mala-drake run --help"]),
        (["run", "--episodes", "many"], ["--episodes", "integer"]),
        (["run", "--seed"], ["--seed", "argument"]),
        (["run", "a.yaml", "b.yaml"], ["b.yaml"]),
        (["run", "--realtime-rate", "fast"], ["--realtime-rate"]),
        (["run", "--realtime-rate", "nan"], ["--realtime-rate: nan", ">= 0"]),
        (["run", "--realtime-rate", "inf"], ["--realtime-rate: inf", ">= 0"]),
        (["run", "--realtime-rate=-1"], ["--realtime-rate: -1", ">= 0"]),
        (["run", "--episodes", "0"], ["--episodes: 0", "from 1"]),
        (["run", "--seed=-1"], ["--seed: -1", ">= 0"]),
        (["run", "--task", "dance"], ["--task: 'dance'", "medication"]),
        (["run", "--profile", "nobody"], ["--profile: 'nobody'", "safety_first"]),
        (["run", "--solver", "guess"], ["--solver: 'guess'", "snopt"]),
        (["run", "nowhere.yaml"], ["nowhere.yaml", "cannot be read"]),
        (["plan", "one.pddl"], ["problem", "mala-drake plan --help"]),
        (["plan", "nowhere.pddl", "nowhere.pddl"], ["nowhere.pddl", "cannot be read"]),
        (["plan", *MEDICATION, "--weights", "1,0"], ["--weights: 2 weights", "5"]),
        (["plan", *MEDICATION, "--weights", "nan,1,0,0,0"], ["--weights.time: nan", "finite"]),
        (["plan", *MEDICATION, "--weights", "1.5,-0.5,0,0,0"], ["--weights.safety: -0.5"]),
        (["plan", *MEDICATION, "--weights", "0.5,0.5,0.5,0,0"], ["--weights", "1.5", "expected 1"]),
        (["plan", *MEDICATION, "--weights", "a,b,c,d,e"], ["--weights", "five numbers"]),
        (["plan", *MEDICATION, "--weights", ""], ["--weights", "five numbers"]),
        (["plan", *MEDICATION, "--timeout", "nan"], ["--timeout: nan", "positive"]),
        (["plan", *MEDICATION, "--timeout", "0"], ["--timeout: 0", "positive"]),
        (["plan", *MEDICATION, "--timeout=-3"], ["--timeout: -3", "positive"]),
        (["plan", *MEDICATION, "--search", "luck"], ["--search: 'luck'", "astar", "ucs"]),
        (["plan", *MEDICATION[::-1]], ["problem_med.pddl", "domain"]),
        (["graph", "--max-depth=-1"], ["--max-depth: -1", ">= 0"]),
        (["graph", "nowhere.yaml"], ["nowhere.yaml", "cannot be read"]),
        (["experiment", "patience"], ["experiment: 'patience'", "convergence"]),
        (["experiment", "convergence", "--profiles", "nobody"], ["--profiles: 'nobody'", "safety_first"]),
        (["experiment", "convergence", "--profiles", ""], ["--profiles: ''", "commas"]),
        (["experiment", "convergence", "--profiles", "safety_first,safety_first"], ["--profiles", "twice"]),
        (["experiment", "convergence", "--profiles", "custom"], ["--profiles: 'custom'", "true_weights"]),
        (["experiment", "convergence", "--seeds", "one"], ["--seeds: 'one'", "whole numbers"]),
        (["experiment", "convergence", "--seeds", "0.5"], ["--seeds: '0.5'", "whole numbers"]),
        (["experiment", "convergence", "--seeds=-1"], ["--seeds: '-1'", "whole numbers"]),
        (["experiment", "convergence", "--seeds", "3-1"], ["--seeds: '3-1'", "whole numbers"]),
        (["experiment", "convergence", "--seeds", "1,0-2"], ["--seeds", "twice"]),
        (["experiment", "convergence", "--episodes", "0"], ["--episodes: 0", "from 1"]),
        (["experiment", "convergence", "--task", "dance"], ["--task: 'dance'", "alternate"]),
        (["experiment", "convergence", "--solver", "guess"], ["--solver: 'guess'", "snopt"]),
        (["experiment", "convergence", "--learners", "guess"], ["--learners: 'guess'", "posterior"]),
        (["experiment", "convergence", "--jobs", "0"], ["--jobs: 0", ">= 1"]),
        (["experiment", "convergence", "--jobs", "many"], ["--jobs", "integer"]),
        (["experiment", "convergence", "--executor", "thoughts"], ["--executor: 'thoughts'", "processes"]),
        (["experiment", "convergence", "--executor", "dask"], ["--address", "scheduler"]),
        (["experiment", "convergence", "--resume", "--overwrite"], ["--resume", "--overwrite"]),
        (["experiment", "convergence", "nowhere.yaml"], ["nowhere.yaml", "cannot be read"]),
        (["bench", "patience"], ["bench: 'patience'", "plant", "mpc", "plan"]),
    ],
)
def test_a_mistake_is_one_line_and_status_two(capfd, arguments, words):
    line = mistake(capfd, *arguments)
    for word in words:
        assert word in line


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{{{", ["my.yaml:1", "not YAML"]),
        ("wheels: 3", ["my.yaml: wheels", "unknown key"]),
        ("episodes: 0", ["my.yaml: episodes: 0"]),
        ("random_seed: -1", ["my.yaml: random_seed: -1"]),
        ("patient: {noise: .nan}", ["my.yaml: patient.noise: nan", "finite"]),
        ("learner: {initial_weights: [1, 1, 1, 1, 1]}", ["my.yaml: learner.initial_weights", "5"]),
        ("world: {obstacles: [{x: 0.1}]}", ["my.yaml: world.obstacles[0]", "home"]),
    ],
)
@pytest.mark.parametrize("command", ["run", "graph"])
def test_a_mistake_in_a_scenario_names_file_and_field(capfd, tmp_path, command, text, words):
    (tmp_path / "my.yaml").write_text(text)
    line = mistake(capfd, command, tmp_path / "my.yaml")
    for word in words:
        assert word in line


def test_a_folder_is_no_file(capfd, tmp_path):
    assert "cannot be read" in mistake(capfd, "run", tmp_path)
    assert "cannot be read" in mistake(capfd, "plan", tmp_path, tmp_path)
    assert "is a folder" in mistake(capfd, "run", "--html", tmp_path, "--out", tmp_path / "results")
    (tmp_path / "diagram.md").mkdir()
    assert "cannot be written" in mistake(capfd, "graph", "--out", tmp_path / "diagram.md")


def test_a_mistake_of_an_experiment_leaves_no_folder(capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mistake(capfd, "experiment", "convergence", "--jobs", "0")
    assert list(tmp_path.iterdir()) == []


def test_an_experiment_is_neither_begun_over_another_one_nor_over_anything_else(capfd, tmp_path):
    (tmp_path / "file").write_text("kept")
    assert "cannot be written" in mistake(capfd, "experiment", "convergence", "--out", tmp_path / "file")
    assert "file" in mistake(capfd, "experiment", "convergence", "--out", tmp_path)
    assert (tmp_path / "file").read_text() == "kept"


@pytest.mark.parametrize("option", ["--out", "--html"])
def test_a_path_below_a_file_cannot_be_written(capfd, tmp_path, option):
    (tmp_path / "file").write_text("kept")
    target = tmp_path / "file" if option == "--out" else tmp_path / "file" / "recording.html"
    others = [] if option == "--out" else ["--out", tmp_path / "results"]
    assert str(tmp_path / "file") in mistake(capfd, "run", option, target, *others, "--json")
    assert (tmp_path / "file").read_text() == "kept"


def test_the_suffix_of_a_graph_is_one_of_four(capfd, tmp_path):
    line = mistake(capfd, "graph", "--out", tmp_path / "diagram.pdf")
    for form in (".pdf", ".dot", ".md", ".svg", ".png"):
        assert form in line


def test_a_graph_is_written_and_named(capfd, tmp_path):
    file = tmp_path / "pictures" / "diagram.md"
    status, output, _ = call(capfd, "graph", "--out", file)
    assert (status, output) == (0, f"wrote {file}\n")
    assert "```mermaid" in file.read_text()


def test_benchmark_rows_are_json_or_a_table(capfd, monkeypatch):
    rows = {"plan": [{"search": "astar", "median_ms": 1.5}]}
    monkeypatch.setattr("mala_drake.experiments.bench.run_benchmarks", {"plan": rows}.get)
    status, output, errors = call(capfd, "bench", "plan", "--json")
    assert (status, json.loads(output), errors) == (0, rows, "")
    status, output, _ = call(capfd, "bench", "plan")
    assert status == 0
    assert "median_ms" in output
    assert "1.5" in output


def test_an_interrupted_run_says_so_without_a_traceback(capfd, monkeypatch, tmp_path):
    def interrupted(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("mala_drake.experiments.run.run_scenario", interrupted)
    status, output, errors = call(capfd, "run", "--out", tmp_path)
    assert (status, output) == (130, "")
    assert errors.strip() == "mala-drake: interrupted; what was written before stays"


def test_another_solver_runs_without_what_the_file_sets_of_its_own(capfd, monkeypatch, tmp_path):
    seen = []

    def interrupted(scenario, *arguments, **options):
        seen.append(scenario)
        raise KeyboardInterrupt

    monkeypatch.setattr("mala_drake.experiments.run.run_scenario", interrupted)
    (tmp_path / "my.yaml").write_text("control: {sqp_iterations: 1, tolerance: 0.001}")
    call(capfd, "run", tmp_path / "my.yaml", "--out", tmp_path)
    call(capfd, "run", tmp_path / "my.yaml", "--out", tmp_path, "--solver", "snopt")
    controls = [(s.control.solver, s.control.sqp_iterations, s.control.tolerance) for s in seen]
    assert controls == [("rti", 1, 0.001), ("snopt", 20, 0.001)]


def test_a_failed_run_is_status_one_with_only_json_on_standard_output(tmp_path):
    (tmp_path / "short.yaml").write_text("episodes: 1\nepisode_time_limit: 1\n")
    done = process("run", "short.yaml", "--out", "results", "--json", folder=tmp_path)
    assert done.returncode == 1, done.stderr
    summary = json.loads(done.stdout)
    assert done.stderr == ""
    assert summary == json.loads((tmp_path / "results" / "summary.json").read_text())
    assert summary["totals"]["successes"] == 0


def test_a_mistake_in_its_own_process_leaves_no_traceback(tmp_path):
    done = process("run", "--out", "results", "--profile", "nobody", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "results").exists()


def test_the_same_seed_gives_the_same_bytes_whatever_the_hash_seed(tmp_path):
    (tmp_path / "short.yaml").write_text("episodes: 1\nepisode_time_limit: 15\nrobot: {position_noise: 0.005}\n")
    lines = {}
    for seed in ("1", "2"):
        done = process("run", "short.yaml", "--out", f"out{seed}", folder=tmp_path, PYTHONHASHSEED=seed)
        assert done.returncode == 1, done.stderr
        assert f"wrote out{seed}/episodes.jsonl" in done.stdout.replace(os.sep, "/")
        text = (tmp_path / f"out{seed}" / "episodes.jsonl").read_text()
        records = [json.loads(line) for line in text.splitlines()]
        lines[seed] = [json.dumps({**record, "timing": None}) for record in records]
    assert len(lines["1"]) == 1
    assert lines["1"] == lines["2"]


def test_a_report_without_results_is_one_line(capfd, tmp_path):
    assert "has no episodes" in mistake(capfd, "report", tmp_path)
    assert "is not a folder" in mistake(capfd, "report", tmp_path / "nowhere")
    assert "folder" in mistake(capfd, "report").lower()
