"""Watching an episode: what is new is told once, and watching changes nothing."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from mala_drake.clock import TICK
from mala_drake.experiments import episode_watch as mut
from mala_drake.experiments.episode import Carried, simulate_episode
from mala_drake.learning.dynamics_estimator import DynamicsEstimator, Transition
from mala_drake.messages import Action, ActionKind
from mala_drake.scenario import Scenario
from mala_drake.station import MakeCareStation
from mala_drake.station_context import StartEpisode, learner_states_of
from mala_drake.ward.features import FEATURE_SCALES

SECONDS = 6.0


@pytest.fixture(scope="module")
def station():
    return MakeCareStation(Scenario(episodes=1))


def state_after(station, *, watched):
    """Everything the station knows after some seconds, and the watch."""
    context = station.CreateDefaultContext()
    StartEpisode(station, context, episode=0)
    simulator = Simulator(station, context)
    simulator.Initialize()
    watch = mut.EpisodeWatch(station, context, Scenario(episodes=1), 0)
    news = []
    for tick in range(1, round(SECONDS / TICK) + 1):
        simulator.AdvanceTo(tick * TICK)
        if watched:
            news += watch.look()
            assert not watch.finished
    plant = station.GetSubsystemByName("plant")
    state = plant.GetPositionsAndVelocities(plant.GetMyContextFromRoot(context))
    return state, watch, news, context


def test_watching_changes_nothing_and_tells_each_action_once(station):
    state, _, news, _ = state_after(station, watched=True)
    unwatched, *_ = state_after(station, watched=False)
    assert state.tolist() == unwatched.tolist()
    assert len(news) == 1
    assert news[0].startswith("drive to pharmacy ")


def test_the_rewards_of_the_actions_add_up_to_the_cost_of_the_episode():
    scenario = Scenario(episodes=1)
    scenario.learner.name, scenario.learner.initial_weights = "fixed", [0.4, 0.3, 0.1, 0.1, 0.1]
    record, _ = simulate_episode(MakeCareStation(scenario), scenario, episode=0, carried=Carried())
    weights = np.array(scenario.learner.initial_weights)
    assert [entry["action"] for entry in record.executed_actions] == record.actions
    costs = [-entry["external_reward"] for entry in record.executed_actions]
    assert max(record.features.values()) < 1.0  # None is cut.
    # All of the episode's time belongs to an action, but a tick before the first and one after the last one.
    ticks = weights[0] * 2 * TICK / FEATURE_SCALES["medication"].time
    assert sum(costs) == pytest.approx(weights @ list(record.features.values()), abs=1.5 * ticks)
    predicted = [cost - entry["cost_mismatch"] for cost, entry in zip(costs, record.executed_actions, strict=True)]
    assert sum(predicted) == pytest.approx(weights @ list(record.predicted_features.values()))


def test_the_errors_of_the_model_are_those_of_the_samples_that_it_is_learned_from():
    scenario = Scenario(episodes=1)
    scenario.control.learned_dynamics = True
    station = MakeCareStation(scenario)
    context = station.CreateDefaultContext()
    StartEpisode(station, context, episode=0)
    simulator = Simulator(station, context)
    simulator.Initialize()
    watch = mut.EpisodeWatch(station, context, scenario, 0)
    states, controls = [], []
    for tick in range(1, round(2 * SECONDS / TICK) + 1):
        simulator.AdvanceTo(tick * TICK)
        watch.look()
        for system, port, log in (("state_estimator", "robot_state", states), ("mpc_controller", "control", controls)):
            source = station.GetSubsystemByName(system)
            log.append(source.GetOutputPort(port).Eval(source.GetMyContextFromRoot(context)).copy())
    learner = DynamicsEstimator()
    learned, errors = learner.initial_state(), []
    for sample in map(Transition, states, controls, states[1:]):
        if learner.describes(sample):
            errors.append((sample.after - learner.prediction(sample, learner.coefficients(learned))[0])[3:])
        learned = learner.update(learned, sample)
    told = learner_states_of(station, context)["dynamics_learner"]
    assert np.array_equal(told, learned)
    record = watch.record(wall_seconds=0.0, cpu_seconds=0.0)
    assert len(errors) > 30
    assert record.dynamics_errors["learned"] == pytest.approx(np.sqrt(np.mean(np.square(errors), axis=0)))
    assert record.dynamics_errors["learned"][2] < 0.5 * record.dynamics_errors["nominal"][2]


def test_where_no_model_is_learned_none_has_errors(station):
    _, watch, *_ = state_after(station, watched=True)
    assert watch.record(wall_seconds=0.0, cpu_seconds=0.0).dynamics_errors is None


def test_an_episode_cut_short_is_a_failure_with_what_was_measured_so_far(station):
    _, watch, _, context = state_after(station, watched=True)
    record = watch.record(wall_seconds=1.5, cpu_seconds=1.0)
    meter = station.GetSubsystemByName("feature_meter")
    measured = meter.GetOutputPort("features").Eval(meter.GetMyContextFromRoot(context))
    controller = station.GetSubsystemByName("mpc_controller")
    assert not record.success
    assert "time" in record.failure
    assert list(record.features.values()) == measured.tolist()
    assert record.features["time"] > 0.0
    assert record.task == "medication"
    assert record.plan_cost > 0.0
    assert record.ratings == [None] * 5
    assert record.weights_after == record.weights_before
    assert record.sim_time_s == pytest.approx(SECONDS)
    assert record.timing["wall_s"] == 1.5
    # The leg under way counts: there was a solve each tick but the first ones.
    assert SECONDS / TICK - 3 <= record.mpc_solves <= SECONDS / TICK
    assert record.mpc_solves <= len(controller.solve_seconds)
    assert record.terminal_errors_m == []
    assert record.battery_end < record.battery_start == 1.0


@pytest.mark.parametrize(
    ("action", "words"),
    [
        (Action(1, ActionKind.MOVE, "go_to_supply_a", ("robot1", "home"), place="supply_A"), "drive to supply A"),
        (
            Action(1, ActionKind.IN_PLACE, "collect_med_insulin", (), place="pharmacy_north"),
            "collect med insulin at pharmacy north",
        ),
        (
            Action(1, ActionKind.IN_PLACE, "deliver_on_bedside_table_left", (), place="patient_bed_left"),
            "deliver on bedside table left",
        ),
        (
            Action(1, ActionKind.IN_PLACE, "collect_ingredient", ("robot1", "pantry", "bread"), place="pantry"),
            "collect bread at pantry",
        ),
        (Action(1, ActionKind.IN_PLACE, "choose_hot_meal", ("robot1",), place=""), "choose hot meal"),
        (Action(1, ActionKind.IN_PLACE, "wait"), "wait"),
    ],
)
def test_actions_are_told_in_words(action, words):
    assert mut.describe(action) == words
