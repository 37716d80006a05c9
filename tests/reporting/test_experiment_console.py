"""What an experiment looks like: a line a finished run, a table at the end, and nothing when it is to be quiet."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from mala_drake.experiments.experiment import RunName
from mala_drake.reporting import experiment_console as mut
from mala_drake.reporting.results import load_results

RUN = RunName("noisy", "safety_first", 3)

FIGURES = {
    "convergence_episode": None,
    "best_distance": 0.101,
    "final_distance": 0.202,
    "plan_variants": ["a", "b"],
    "runs": 5,
    "converged": 2,
    "dominant_right": 4,
    "episodes": 20,
    "successes": 19,
    "collisions": 7,
}
SUMMARY = {
    "experiment": "convergence",
    "condition": "",
    "scenario": {"learner": {"name": "posterior"}},
    "profiles": {"presentation_focused": {**FIGURES, "convergence_episode": 1.5}},
    "conditions": {"projected_gradient": {"profiles": {"presentation_focused": FIGURES}}},
    "unfinished": {"noisy, safety_first, seed 3": "episode 2: its process was killed by [SIGKILL]"},
}


def show(capsys, *, quiet=False):
    with mut.ExperimentConsole(quiet=quiet) as console:
        console.on_start(runs=2, episodes=8, done=3)
        console.on_episode(RUN, 1)
        console.on_failure(RUN, "episode 2: its process was killed by [SIGKILL]")
        console.show(SUMMARY)
        console.show_files([Path("results/summary.json")])
    return capsys.readouterr()


def test_progress_is_told_on_standard_error_and_results_on_standard_output(capsys):
    output = show(capsys)
    assert output.err.splitlines() == [
        "2 runs, 8 episodes, of which 3 are there already",
        "noisy, safety_first, seed 3: failed in episode 2: its process was killed by [SIGKILL]",
    ]
    assert "wrote results/summary.json" in output.out


def test_the_table_has_a_row_for_each_condition_and_patient(capsys):
    lines = [line.split() for line in show(capsys).out.splitlines()]
    assert ["presentation_focused", "2/5", "1.5", "0.202", "4/5", "2", "19/20", "7"] in lines
    assert ["presentation_focused", "2/5", "never", "0.202", "4/5", "2", "19/20", "7"] in lines
    assert lines.index(["posterior"]) < lines.index(["projected_gradient"])


def test_the_table_fits_a_terminal(capsys):
    table = show(capsys).out.partition("unfinished")[0]
    assert max(map(len, table.splitlines())) <= 80
    assert "presentation_focused" in table
    assert "…" not in table


def test_what_is_unfinished_is_said_at_the_end(capsys):
    assert "unfinished: noisy, safety_first, seed 3 (failed in episode 2: its process was killed by [SIGKILL])" in show(
        capsys
    ).out.replace("\n", " ")


def test_a_run_that_ends_before_a_change_of_mind_has_a_dash(capsys):
    with mut.ExperimentConsole(quiet=False) as console:
        figures = {**FIGURES, "best_distance": None, "final_distance": None}
        console.show({**SUMMARY, "profiles": {"presentation_focused": figures}, "conditions": {}})
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["presentation_focused", "2/5", "never", "-", "4/5", "2", "19/20", "7"] in lines


def test_a_finished_run_has_converged_since_the_change_of_mind(capsys, simulate_results, tmp_path):
    def change(record):
        return replace(record, distance_to_true=[0.1, 0.6, 0.6, 0.1][record.episode])

    simulate_results(tmp_path, profiles=("safety_first",), seeds=(3,), change=change)
    records = load_results(tmp_path).runs[0].episodes
    with mut.ExperimentConsole(quiet=False) as console:
        console.on_run(RUN, records, earlier_episodes=2)
    assert "converged after 2," in capsys.readouterr().err


def test_a_finished_run_is_a_line(capsys, simulate_results, tmp_path):
    from mala_drake.experiments.episode_reader import read_episodes

    simulate_results(tmp_path, profiles=("safety_first",), seeds=(3,))
    records, _ = read_episodes(tmp_path / "safety_first" / "seed_3" / "episodes.jsonl")
    with mut.ExperimentConsole(quiet=False) as console:
        console.on_run(RUN, records, earlier_episodes=0)
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert line.startswith("noisy, safety_first, seed 3: 4 of 4 delivered, ")
    assert f"preferences off by {records[-1].distance_to_true:.3f}, 0 collisions" in line


def test_quiet_is_quiet(capsys):
    output = show(capsys, quiet=True)
    assert (output.out, output.err) == ("", "")
