"""Episodes on one station: contexts that do not know of each other, and what is carried between them."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from mala_drake import station_context as mut
from mala_drake.clock import TICK
from mala_drake.errors import BadInput
from mala_drake.learning import Posterior
from mala_drake.robot.plant_state import X, Y
from mala_drake.scenario import Scenario
from mala_drake.station import MakeCareStation

from .station_ports import read, robot_state


@pytest.fixture(scope="module")
def station():
    return MakeCareStation(Scenario())


def test_two_contexts_of_one_diagram_run_alike(station):
    states = []
    for _ in range(2):
        context = station.CreateDefaultContext()
        mut.StartEpisode(station, context, episode=1, time=0.0)
        simulator = Simulator(station, context)
        simulator.AdvanceTo(5.0)
        states.append(robot_state(station, context).copy())
        assert read(station, context, "scheduler", "task").episode == 1
    assert (states[0] == states[1]).all()


def test_a_later_start_on_the_clock_changes_nothing_but_the_clock(station):
    travelled = []
    for time in (0.0, 500 * TICK):
        context = station.CreateDefaultContext()
        mut.StartEpisode(station, context, episode=0, time=time)
        simulator = Simulator(station, context)
        simulator.AdvanceTo(time + 5.0)
        travelled.append(robot_state(station, context)[[X, Y]].copy())
    assert travelled[0] == pytest.approx(travelled[1], abs=0.02)


def test_learned_weights_are_carried_into_the_next_episode(station):
    context = station.CreateDefaultContext()
    learner = Posterior()
    learned = learner.update(learner.initial_state(), ratings=(3.0, 4.0, 4.5, 4.5, 4.5), features=(0.9,) * 5)
    states = {**mut.learner_states_of(station, context), "preference_learner": learned}
    mut.StartEpisode(station, context, episode=1, learner_states=states)
    assert list(mut.learner_states_of(station, context)) == ["preference_learner", "cost_learner"]
    assert mut.learner_states_of(station, context)["preference_learner"] == pytest.approx(learned)
    assert read(station, context, "preference_learner", "preferences").estimate == pytest.approx(
        learner.estimate(learned)
    )


@pytest.mark.parametrize("states", [{}, {"preference_learner": np.zeros(2)}, {"another_learner": np.zeros(6)}])
def test_what_another_stations_learners_have_learned_is_refused(station, states):
    context = station.CreateDefaultContext()
    with pytest.raises(BadInput, match=r"learner_states.*expected numbers of preference_learner"):
        mut.StartEpisode(station, context, episode=1, learner_states=states)
