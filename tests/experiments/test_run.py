"""Running a scenario: the closed loop delivers, and what is written is what happened."""

from __future__ import annotations

import dataclasses
import json

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import run as mut
from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.learning.convergence import preference_distance
from mala_drake.patient.profiles import PROFILES
from mala_drake.scenario import ControlConfig, Scenario

WEIGHTS = PROFILES["speed_oriented"]


class Notes:
    """Keeps what a run tells."""

    def __init__(self):
        self.actions, self.records = [], []

    def on_action(self, episode, seconds, text):
        self.actions.append((episode, seconds, text))

    def on_episode(self, record):
        self.records.append(record)


def short(**changes):
    """A scenario whose episodes fail for lack of time: cheap."""
    return dataclasses.replace(Scenario(episodes=1, episode_time_limit=1.0), **changes)


@pytest.fixture(scope="session")
def delivery(tmp_path_factory):
    """One whole medication episode: its folder, its summary, and what was told of it."""
    folder, notes = tmp_path_factory.mktemp("delivery"), Notes()
    summary = mut.run_scenario(Scenario(episodes=1), mut.RunOptions(out=folder), watcher=notes)
    return folder, summary, notes


def test_medicine_and_supplement_are_delivered_and_the_robot_learns(delivery):
    _, summary, notes = delivery
    (record,) = notes.records
    assert record.success
    assert record.failure is None
    assert record.actions[-1].startswith("(deliver_on_bedside_table_")
    assert record.collisions == summary["totals"]["collisions"] == 0
    assert record.mpc_failures == record.mpc_not_converged == 0 < record.mpc_solves
    assert record.min_clearance_m >= 0.05
    assert max(record.terminal_errors_m) <= 0.15
    assert max(record.terminal_yaw_errors_rad) <= 0.2
    assert max(record.terminal_speeds_m_s) <= 0.05
    assert record.distance_to_true < preference_distance(record.weights_before, WEIGHTS)
    assert record.distance_to_true == pytest.approx(preference_distance(record.weights_after, WEIGHTS))
    assert len(record.terminal_errors_m) == sum(text.startswith("drive") for _, _, text in notes.actions) == 3
    assert 0.0 < record.battery_end < record.battery_start == 1.0
    entries = record.executed_actions
    assert [entry["action"] for entry in entries] == record.actions
    assert max(entry["state_mismatch"] for entry in entries) == 0.0
    assert sum(entry["closed_loop_cost"] is not None for entry in entries) == 3
    assert max(abs(entry["cost_mismatch"]) for entry in entries) < 0.05
    for criterion, value in record.features.items():
        assert value == pytest.approx(record.predicted_features[criterion], abs=0.1)


def test_files_hold_what_the_run_returned_and_told(delivery):
    folder, summary, notes = delivery
    lines = (folder / "episodes.jsonl").read_text(encoding="utf-8").splitlines()
    assert lines == [record.to_json() for record in notes.records]
    assert json.loads((folder / "summary.json").read_text(encoding="utf-8")) == summary
    assert list(summary) == ["version", "fingerprint", "scenario", "seed", "totals", "profiles", "timing"]
    assert set(summary["profiles"]["speed_oriented"]) == {
        "convergence_episode",
        "best_distance",
        "final_distance",
        "success_rate",
        "plan_variants",
    }
    assert summary["totals"]["successes"] == 1
    assert summary["profiles"]["speed_oriented"]["plan_variants"] == [notes.records[0].plan_variant]


def test_an_episode_out_of_time_has_failed_and_the_next_one_begins_anew(tmp_path):
    notes = Notes()
    summary = mut.run_scenario(short(episodes=2), mut.RunOptions(out=tmp_path), watcher=notes)
    assert summary["totals"]["successes"] == 0
    assert summary["totals"]["failures"] == ["the time of the episode was up"] * 2
    assert [record.sim_time_s for record in notes.records] == pytest.approx([1.0, 1.0])
    assert [record.battery_start for record in notes.records] == [1.0, 1.0]
    assert [episode for episode, _, _ in notes.actions] == [0, 1]
    assert max(seconds for _, seconds, _ in notes.actions) <= 1.0
    # Each explores with weights of its own, but nothing was learned.
    assert notes.records[0].plan_cost != notes.records[1].plan_cost
    assert notes.records[1].weights_after == pytest.approx([0.2] * 5)


def test_a_new_run_replaces_the_results_of_an_earlier_one(tmp_path):
    for name in ("episodes.jsonl", "summary.json"):
        (tmp_path / name).write_text("old")
    mut.run_scenario(short(), mut.RunOptions(out=tmp_path))
    assert len((tmp_path / "episodes.jsonl").read_text().splitlines()) == 1
    assert json.loads((tmp_path / "summary.json").read_text())["totals"]["episodes"] == 1


def test_an_interrupted_run_keeps_its_episodes_and_no_summary_of_another(tmp_path):
    class Impatient(Notes):
        def on_episode(self, record):
            raise KeyboardInterrupt

    (tmp_path / "summary.json").write_text("of an earlier run")
    with pytest.raises(KeyboardInterrupt):
        mut.run_scenario(short(episodes=3), mut.RunOptions(out=tmp_path), watcher=Impatient())
    assert len((tmp_path / "episodes.jsonl").read_text().splitlines()) == 1
    assert not (tmp_path / "summary.json").exists()


@pytest.mark.parametrize("mistake", ["episodes", "html"])
def test_a_mistake_leaves_earlier_results_alone(tmp_path, mistake):
    (tmp_path / "episodes.jsonl").write_text("old")
    scenario = short(episodes=0) if mistake == "episodes" else short()
    options = mut.RunOptions(out=tmp_path, html=tmp_path if mistake == "html" else None)
    with pytest.raises(BadInput):
        mut.run_scenario(scenario, options)
    assert (tmp_path / "episodes.jsonl").read_text() == "old"


def test_a_summary_that_cannot_be_written_is_told_in_one_line_and_leaves_the_episodes(tmp_path):
    (tmp_path / "summary.json.new").mkdir()
    with pytest.raises(BadInput, match=r"summary\.json: cannot be written"):
        mut.run_scenario(short(), mut.RunOptions(out=tmp_path))
    assert len((tmp_path / "episodes.jsonl").read_text().splitlines()) == 1


def test_without_a_folder_nothing_is_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mut.run_scenario(short(), mut.RunOptions(out=None))
    assert list(tmp_path.iterdir()) == []


def test_real_time_iterations_are_driven_with_and_are_no_failures():
    scenario = short(episode_time_limit=4.0, control=ControlConfig(sqp_iterations=1))
    totals = mut.run_scenario(scenario, mut.RunOptions(out=None))["totals"]
    assert totals["mpc_failures"] == 0 < totals["mpc_not_converged"] <= totals["mpc_solves"]


def test_a_recording_explains_the_run(tmp_path):
    options = mut.RunOptions(out=tmp_path / "results", html=tmp_path / "new" / "recording.html")
    mut.run_scenario(short(), options)
    page = (tmp_path / "new" / "recording.html").read_text(encoding="utf-8")
    assert "<title>medication, patient speed oriented</title>" in page
    assert "Episode 1: drive to pharmacy" in page
    assert all(path.is_file() for path in options.files)


def episode(distance, *, rated=True, success=True, clearance=0.2, variant="a"):
    fields = {field.name: 0 for field in dataclasses.fields(EpisodeRecord)}
    values = {
        "success": success,
        "failure": None if success else "blocked",
        "plan_variant": variant,
        "ratings": [3.0 if rated else None] * 5,
        "distance_to_true": distance,
        "min_clearance_m": clearance,
        "terminal_errors_m": [],
        "terminal_yaw_errors_rad": [],
        "terminal_speeds_m_s": [],
        "timing": {"wall_s": 2.0, "cpu_s": 1.5, "mpc_median_ms": 4.0},
    }
    return EpisodeRecord(**{**fields, **values})


def test_convergence_counts_rated_episodes_only():
    records = [episode(0.3), episode(0.3, rated=False, success=False), episode(0.2), episode(0.1), episode(0.12)]
    figures = mut.summarise(Scenario(), records)["profiles"]["speed_oriented"]
    assert figures["convergence_episode"] == 3
    assert figures["best_distance"] == 0.1
    assert figures["final_distance"] == 0.12
    assert figures["success_rate"] == 0.8


def test_a_learner_that_never_comes_near_has_not_converged():
    figures = mut.summarise(Scenario(), [episode(0.3), episode(0.16)])["profiles"]["speed_oriented"]
    assert figures["convergence_episode"] is None


def test_what_is_learned_is_counted_since_a_change_of_mind():
    scenario = Scenario(episodes=4)
    scenario.patient.earlier_weights, scenario.patient.earlier_episodes = [0.2] * 5, 2
    records = [episode(0.05), episode(0.05), episode(0.4), episode(0.14)]
    figures = mut.summarise(scenario, records)["profiles"]["speed_oriented"]
    assert (figures["convergence_episode"], figures["best_distance"], figures["final_distance"]) == (2, 0.14, 0.14)
    assert figures["success_rate"] == 1.0
    figures = mut.summarise(scenario, records[:2])["profiles"]["speed_oriented"]
    assert (figures["convergence_episode"], figures["best_distance"], figures["final_distance"]) == (None, None, None)


def test_only_plans_that_delivered_count_as_variants():
    records = [episode(0.3, variant="b"), episode(0.3, variant="a"), episode(0.3, variant="c", success=False)]
    summary = mut.summarise(Scenario(), records)
    assert summary["profiles"]["speed_oriented"]["plan_variants"] == ["a", "b"]
    assert summary["totals"]["failures"] == ["blocked"]


def test_solves_that_stopped_early_are_added_up_where_they_are_told():
    records = [episode(0.3), episode(0.3), episode(0.3)]
    for record, failures, stopped in zip(records, (0, 1, 2), (5, 7, None), strict=True):
        record.mpc_failures, record.mpc_not_converged = failures, stopped
    totals = mut.summarise(Scenario(), records)["totals"]
    assert (totals["mpc_failures"], totals["mpc_not_converged"]) == (3, 12)


def test_a_leg_whose_end_was_not_measured_is_not_the_worst_one():
    one, other = episode(0.3), episode(0.3)
    one.terminal_errors_m, one.terminal_yaw_errors_rad = [None, 0.02], [None]
    other.terminal_errors_m, other.terminal_speeds_m_s = [0.05, None], [0.01]
    totals = mut.summarise(Scenario(), [one, other])["totals"]
    worst = [totals[f"max_terminal_{name}"] for name in ("error_m", "yaw_error_rad", "speed_m_s")]
    assert worst == [0.05, None, 0.01]


def test_a_summary_is_json_even_where_nothing_was_near():
    summary = mut.summarise(Scenario(), [episode(0.3, clearance=float("inf"))])
    assert summary["totals"]["min_clearance_m"] is None
    assert summary["totals"]["max_terminal_error_m"] is None
    assert json.loads(json.dumps(summary, allow_nan=False)) == summary
