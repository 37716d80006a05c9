"""One station a task: fewer boxes, the same episodes."""

from __future__ import annotations

import pytest
from pydrake.geometry import Meshcat

from mala_drake.errors import BadInput
from mala_drake.experiments import stations as mut
from mala_drake.experiments.episode import Carried, simulate_episode
from mala_drake.scenario import Scenario
from mala_drake.station import MakeCareStation

SCENARIO = Scenario(task="alternate", episodes=4, episode_time_limit=8.0)


def boxes(station):
    plant = station.GetSubsystemByName("plant")
    return len(plant.GetFloatingBaseBodies()) - 1


@pytest.fixture(scope="module")
def dut():
    return mut.Stations(SCENARIO)


def test_there_is_one_station_a_task(dut):
    assert dut.of_episode(0) is dut.of_episode(2)
    assert dut.of_episode(1) is dut.of_episode(3)
    assert dut.of_episode(0) is not dut.of_episode(1)


def test_each_has_the_boxes_of_its_task_only(dut):
    medication, meal, both = boxes(dut.of_episode(0)), boxes(dut.of_episode(1)), boxes(MakeCareStation(SCENARIO))
    assert medication > 0 < meal
    assert medication + meal == both


@pytest.mark.parametrize("episode", [0, 1])
def test_the_boxes_of_another_task_change_nothing(dut, episode):
    def simulated(station):
        record, carried = simulate_episode(station, SCENARIO, episode=episode, carried=Carried())
        return {**record.__dict__, "timing": None}, carried

    assert simulated(dut.of_episode(episode)) == simulated(MakeCareStation(SCENARIO))


def test_what_is_shown_has_all_boxes():
    dut = mut.Stations(SCENARIO, meshcat=Meshcat())
    assert dut.of_episode(0) is dut.of_episode(1)
    assert boxes(dut.of_episode(0)) == boxes(MakeCareStation(SCENARIO))


def test_refuses_a_task_that_no_episode_has():
    with pytest.raises(BadInput, match="'surgery'"):
        MakeCareStation(SCENARIO, task="surgery")
