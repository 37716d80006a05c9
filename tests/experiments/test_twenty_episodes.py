"""Twenty episodes on the executed physics: delivered, nothing touched, every leg stopped in its pose."""

from __future__ import annotations

import json

import pytest

from mala_drake.experiments.run import RunOptions, run_scenario
from mala_drake.patient.profiles import PROFILES
from mala_drake.scenario import Scenario


def assert_delivered(scenario, tmp_path):
    summary = run_scenario(scenario, RunOptions(out=tmp_path))
    assert summary["totals"]["successes"] == 20
    assert summary["totals"]["collisions"] == 0
    assert summary["totals"]["min_clearance_m"] >= 0.05
    records = [json.loads(line) for line in (tmp_path / "episodes.jsonl").read_text().splitlines()]
    assert len(records) == 20
    for record in records:
        assert max(record["terminal_errors_m"]) <= 0.15
        assert max(record["terminal_yaw_errors_rad"]) <= 0.2
        assert max(record["terminal_speeds_m_s"]) <= 0.05
    return records


@pytest.mark.slow
def test_twenty_medication_episodes_are_delivered_without_a_touch(tmp_path):
    assert_delivered(Scenario(episodes=20), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("profile", PROFILES)
def test_medication_and_meals_in_turn_are_delivered_without_a_touch(tmp_path, profile):
    scenario = Scenario(task="alternate", episodes=20)
    scenario.patient.profile = profile
    records = assert_delivered(scenario, tmp_path)
    assert [record["task"] for record in records] == ["medication", "meal"] * 10
    # What is predicted is what is measured, but for boxes that were the wrong ones.
    for record in records:
        if not any("wrong" in action for action in record["actions"]):
            for name, value in record["features"].items():
                assert value == pytest.approx(record["predicted_features"][name], abs=0.06), (record["episode"], name)
