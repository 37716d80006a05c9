"""Twenty medication episodes on the executed physics: delivered, nothing touched, every leg stopped in its pose."""

from __future__ import annotations

import json

import pytest

from mala_drake.experiments.run import RunOptions, run_scenario
from mala_drake.scenario import Scenario


@pytest.mark.slow
def test_twenty_episodes_are_delivered_without_a_touch(tmp_path):
    summary = run_scenario(Scenario(episodes=20), RunOptions(out=tmp_path))
    assert summary["totals"]["successes"] == 20
    assert summary["totals"]["collisions"] == 0
    assert summary["totals"]["min_clearance_m"] >= 0.05
    records = [json.loads(line) for line in (tmp_path / "episodes.jsonl").read_text().splitlines()]
    assert len(records) == 20
    for record in records:
        assert max(record["terminal_errors_m"]) <= 0.15
        assert max(record["terminal_yaw_errors_rad"]) <= 0.2
        assert max(record["terminal_speeds_m_s"]) <= 0.05
