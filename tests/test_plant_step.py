"""What an episode comes to does not hang on the step of the plant."""

import json
import subprocess
import sys

import pytest

EPISODE = """
import json, sys
import mala_drake.clock as clock
clock.PLANT_STEP = float(sys.argv[1])
from mala_drake.experiments.episode import Carried, simulate_episode
from mala_drake.scenario import Scenario
from mala_drake.station import MakeCareStation
scenario = Scenario(task=sys.argv[2], episodes=1)
record, _ = simulate_episode(MakeCareStation(scenario), scenario, episode=0, carried=Carried())
print(record.to_json())
"""


def episode(step, task):
    command = [sys.executable, "-c", EPISODE, str(step), task]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


@pytest.mark.slow
@pytest.mark.parametrize("task", ["medication", "meal"])
def test_a_step_eight_times_shorter_gives_the_same_episode(task):
    coarse, fine = (episode(step, task) for step in (0.02, 0.0025))
    assert coarse["success"]
    assert fine["success"]
    assert coarse["actions"] == fine["actions"]
    assert coarse["features"] == pytest.approx(fine["features"], abs=0.01)
    assert coarse["min_clearance_m"] == pytest.approx(fine["min_clearance_m"], abs=0.01)
    assert coarse["terminal_errors_m"] == pytest.approx(fine["terminal_errors_m"], abs=0.01)
