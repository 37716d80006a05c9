"""The tables of the inner loop, cell by cell, against figures counted by hand."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import pytest

from mala_drake.reporting import inner_loop_tables as mut
from mala_drake.reporting.results import load_results
from mala_drake.scenario import Scenario


def load(folder, simulate_results, change, *, told=True, **more):
    simulate_results(folder, profiles=("speed_oriented",), episodes=3, change=change, **more)
    if told:
        (folder / "summary.json").write_text(json.dumps({"scenario": asdict(Scenario())}))
    return load_results(folder)


def test_actions_are_counted_condition_by_condition(tmp_path, simulate_results, with_actions):
    def block(record):
        record = with_actions(record, wrong_items=(2,))
        record.executed_actions[0]["outcome"] = "blocked"
        return record

    load(tmp_path, simulate_results, with_actions)
    results = load(tmp_path, simulate_results, block, condition="blocked", seeds=(0,))
    (group,) = mut.action_table(results).groups
    # |E^C| of the three episodes: 2.025, 1.0125 and 0.50625 thousandths.
    assert group.rows == (
        ("posterior", "24", "0", "-0.350", "50.0", "1.5", "0.51", "0.0000", "0.0000"),
        ("blocked", "12", "3", "-0.350", "50.0", "1.5", "0.51", "0.0000", "0.2500"),
    )


def test_one_episode_has_no_second_half(tmp_path, simulate_results, with_actions):
    simulate_results(tmp_path, profiles=("speed_oriented",), episodes=1, change=with_actions)
    ((row,),) = (group.rows for group in mut.action_table(load_results(tmp_path)).groups)
    assert row[5:] == ("2.0", "–", "0.0000", "–")


def test_the_model_stands_beside_the_truth(tmp_path, simulate_results, with_learned_control):
    results = load(tmp_path, simulate_results, with_learned_control)
    (group,) = mut.dynamics_table(results).groups
    rows = {row[0]: row[1:] for row in group.rows}
    nominal, true, learned, reach, off, met = rows["Yaw coupling c, 1/m"]
    assert (nominal, learned, reach, off, met) == ("0", "0.350", "0.013", "0.0 %", "2/2")
    least, greatest = map(float, true.split("–"))
    assert 0.25 < least < 0.35 < greatest < 0.4
    # Not between nothing and two boxes, and sure of it.
    assert rows["Brake gain"][-2:] == ("4.3 %", "0/2")
    assert rows["Lateral damping k, 1/s"] == ("5", "–", "8.000", "0.013", "–", "–")


def test_without_a_scenario_there_is_no_truth(tmp_path, simulate_results, with_learned_control):
    results = load(tmp_path, simulate_results, with_learned_control, told=False)
    (group,) = mut.dynamics_table(results).groups
    assert {row[2] for row in group.rows} == {"–"}


@pytest.mark.parametrize("make", [mut.action_table, mut.dynamics_table])
def test_where_nothing_is_told_there_is_no_table(tmp_path, simulate_results, make):
    assert make(load(tmp_path, simulate_results, None)) is None


def test_a_run_that_has_learned_nothing_yet_is_nominal(tmp_path, simulate_results, with_learned_control):
    def late(record):
        record = with_learned_control(record)
        return replace(record, learned_dynamics={}) if record.seed else record

    results = load(tmp_path, simulate_results, late)
    (group,) = mut.dynamics_table(results).groups
    assert {row[0]: row[3] for row in group.rows}["Propulsion gain"] == "0.978"
