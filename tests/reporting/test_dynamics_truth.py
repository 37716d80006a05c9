"""The truth about the robot of a folder of results, as far as it can be known."""

from __future__ import annotations

import json
from dataclasses import asdict

import pytest

from mala_drake.reporting import dynamics_truth as mut
from mala_drake.reporting.results import load_results
from mala_drake.robot.true_dynamics import true_dynamics
from mala_drake.scenario import Scenario


def results(folder, simulate_results, robot):
    simulate_results(folder, profiles=("speed_oriented",), seeds=(0,), episodes=1)
    scenario = asdict(Scenario())
    scenario["robot"] |= robot
    (folder / "summary.json").write_text(json.dumps({"scenario": scenario}))
    return load_results(folder)


def test_it_is_that_of_the_robot_that_was_simulated(tmp_path, simulate_results):
    told = results(tmp_path, simulate_results, {"hidden_truth": 0.5, "gyroscopic_effect": 2.0})
    empty, _, laden = mut.truths(told, told.main)
    assert empty == true_dynamics(hidden_truth=0.5, gyroscopic_effect=2.0)
    assert laden == true_dynamics(hidden_truth=0.5, gyroscopic_effect=2.0, boxes=2)
    assert mut.true_range((empty, laden), "propulsion_gain") == (laden.propulsion_gain, empty.propulsion_gain)
    assert mut.true_range((empty, laden), "yaw_coupling") == (empty.yaw_coupling, laden.yaw_coupling)


def test_what_has_no_truth_of_its_own_has_none(tmp_path, simulate_results):
    told = results(tmp_path, simulate_results, {})
    assert mut.true_range(mut.truths(told, told.main), "lateral_damping") is None


@pytest.mark.parametrize("scale", [None, "much", 1e6])
def test_of_a_robot_that_is_none_nothing_is_known(tmp_path, simulate_results, scale):
    told = results(tmp_path, simulate_results, {"hidden_truth": scale})
    assert mut.truths(told, told.main) == ()
    assert mut.true_range((), "yaw_gain") is None
