"""What a run looks like on a terminal."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mala_drake.experiments.episode_record import EpisodeRecord, by_criterion
from mala_drake.experiments.run import summarise
from mala_drake.reporting import console as mut
from mala_drake.scenario import Scenario


def episode(*, success=True, failure=None, clearance=0.213):
    fields = {field.name: 0 for field in dataclasses.fields(EpisodeRecord)}
    values = {
        "success": success,
        "failure": failure,
        "actions": ["(go_to_pharmacy_north robot1 home)", "(collect_med_antibiotic robot1 pharmacy_north)"],
        "plan_variant": "north/A/med-supp/left",
        "features": by_criterion([0.61, 0.52, 0.43, 0.34, 0.25]),
        "ratings": [4.25, 4.5, None, 4.75, 3.5],
        "weights_after": [0.31, 0.21, 0.19, 0.18, 0.11],
        "distance_to_true": 0.123,
        "sim_time_s": 97.5,
        "min_clearance_m": clearance,
        "terminal_errors_m": [0.014],
        "terminal_yaw_errors_rad": [0.045],
        "terminal_speeds_m_s": [0.009],
        "timing": {"wall_s": 8.5, "cpu_s": 8.0, "mpc_median_ms": 7.6},
    }
    return EpisodeRecord(**{**fields, **values})


def show(record, capsys, *, quiet=False):
    """Standard output and error of a run of one episode."""
    scenario = Scenario(episodes=1)
    with mut.RunConsole(scenario, quiet=quiet) as console:
        console.on_action(0, 1.0, "drive to [somewhere]")
        console.on_episode(record)
    console.show(summarise(scenario, [record]))
    console.show_files([Path("results/episodes.jsonl"), Path("results/[odd].html")])
    return capsys.readouterr()


@pytest.mark.parametrize("columns", ["80", "120"])
def test_a_summary_tells_outcome_plan_and_what_was_learned(capsys, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    output, errors = show(episode(), capsys)
    words = ["1 of 1", "0.213 m", "0.014 m, 0.045 rad, 0.009 m/s", "north/A/med-supp/left", "0.123", "7.6 ms", "8.5 s"]
    words += ["go to pharmacy north", "collect med antibiotic"]
    for word in words:
        assert word in output
    assert "episode 1: delivered, 97.5 s" in errors
    assert max(map(len, output.splitlines())) <= int(columns)


def test_weights_stand_beside_the_true_ones(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    output, _ = show(episode(), capsys)
    rows = {line.split()[1]: line.split()[3::2] for line in output.splitlines() if line.startswith("\u2502 ")}
    assert rows["time"] == ["0.310", "0.500", "0.610", "4.25"]
    assert rows["battery"] == ["0.190", "0.140", "0.430", "-"]


def test_files_are_named_one_a_line(capsys):
    output, _ = show(episode(), capsys)
    assert output.splitlines()[-2:] == ["wrote results/episodes.jsonl", "wrote results/[odd].html"]


def test_a_failure_says_why(capsys):
    output, errors = show(episode(success=False, failure="blocked [at the door]"), capsys)
    assert "0 of 1" in output
    assert "1 x blocked [at the door]" in output
    assert "failed: blocked [at the door]" in errors


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
@given(reason=st.text(alphabet="[]/abc\\ ", max_size=12))
def test_no_text_of_a_failure_upsets_the_console(capsys, reason):
    _, errors = show(episode(success=False, failure=reason), capsys)
    assert reason.strip() in errors


def test_a_clearance_that_nothing_limits_is_a_dash(capsys):
    output, errors = show(episode(clearance=float("inf")), capsys)
    assert "- m" in output
    assert "clearance - m" in errors
    assert "inf" not in output + errors.replace("info", "")


def test_solves_that_stopped_early_are_told_apart_from_failures(capsys):
    output, _ = show(dataclasses.replace(episode(), mpc_solves=255, mpc_not_converged=83), capsys)
    assert "255, 0 failed, 83 stopped early" in " ".join(output.split())
    output, _ = show(episode(), capsys)
    assert "stopped early" not in output


def test_before_a_change_of_mind_distances_are_dashes(capsys):
    scenario = Scenario(episodes=1)
    scenario.patient.earlier_weights, scenario.patient.earlier_episodes = [0.2] * 5, 1
    with mut.RunConsole(scenario, quiet=False) as console:
        console.show(summarise(scenario, [episode()]))
    assert "- (best -)" in capsys.readouterr().out


def test_quiet_means_nothing_at_all(capsys):
    assert show(episode(), capsys, quiet=True) == ("", "")


def test_benchmark_rows_are_a_table(capsys):
    mut.print_rows("plan", [{"search": "astar", "median_ms": 1.23456, "count": 20}])
    output = capsys.readouterr().out
    for word in ("plan", "search", "median_ms", "astar", "1.23", "20"):
        assert word in output
    assert "1.23456" not in output


def test_a_table_too_wide_for_the_terminal_is_turned_and_loses_nothing(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    rows = [{"solver": f"solver_{i}", **{f"figure_{j}": 1000 * i + j for j in range(12)}} for i in range(7)]
    mut.print_rows("wide", rows)
    output = capsys.readouterr().out
    assert max(map(len, output.splitlines())) <= 60
    assert "…" not in output
    for row in rows:
        assert all(str(value) in output for value in row.values())
    assert output.count("figure_11") == 2  # In two parts.


def test_no_rows_are_no_columns(capsys):
    mut.print_rows("empty", [])
    assert json.dumps("median_ms") not in capsys.readouterr().out
