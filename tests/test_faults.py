"""What goes wrong in a ward, on the executed physics: each fault has its answer, success is never feigned."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from mala_drake.clock import SENSE_OFFSET, TICK
from mala_drake.experiments.run import RunOptions, run_scenario
from mala_drake.messages import Outcome
from mala_drake.patient.profiles import PROFILES
from mala_drake.robot.plant_state import V_X, X, Y
from mala_drake.scenario import ObstacleConfig, Scenario
from mala_drake.station import MakeCareStation
from mala_drake.station_context import StartEpisode


class Notes:
    """Keeps what a run tells."""

    def __init__(self):
        self.actions, self.records = [], []

    def on_action(self, episode, seconds, text):
        self.actions.append(text)

    def on_episode(self, record):
        self.records.append(record)


def one_episode(**changes):
    """One episode of a robot that knows its patient is in a hurry; keyword arguments set `section__field`."""
    scenario = Scenario(episodes=1)
    scenario.learner.name = "fixed"
    scenario.learner.initial_weights = list(PROFILES["speed_oriented"])
    scenario.world.wrong_item_probability = 0.0
    for name, value in changes.items():
        target, _, field = name.rpartition("__")
        setattr(getattr(scenario, target) if target else scenario, field, value)
    return scenario


def run(scenario):
    notes = Notes()
    run_scenario(scenario, RunOptions(out=None), watcher=notes)
    return notes.records[0], notes.actions


class Episode:
    """A station stepped tick by tick, with access to what a fault needs."""

    def __init__(self, scenario):
        self.station = MakeCareStation(scenario)
        self.context = self.station.CreateDefaultContext()
        StartEpisode(self.station, self.context, episode=0)
        self.simulator = Simulator(self.station, self.context)
        self.simulator.Initialize()
        self.plant, self.plant_context = self.own("plant")
        self.robot = self.plant.GetModelInstanceByName("care_robot")
        self.base = self.plant.GetBodyByName("base", self.robot)
        self.ticks = 0

    def own(self, name):
        system = self.station.GetSubsystemByName(name)
        return system, system.GetMyMutableContextFromRoot(self.context)

    def read(self, name, port):
        system, context = self.own(name)
        return system.GetOutputPort(port).Eval(context)

    def advance(self, seconds, until=lambda: False):
        for _ in range(round(seconds / TICK)):
            self.ticks += 1
            self.simulator.AdvanceTo(self.ticks * TICK)
            if until():
                return True
        return False

    def state(self):
        return self.plant.get_state_output_port(self.robot).Eval(self.plant_context)

    def finished(self):
        return self.read("scheduler", "closed")[0] > 0

    def report(self):
        return self.read("scheduler", "progress").reports[-1]


def test_wrong_items_are_found_and_put_back_and_the_right_ones_delivered():
    record, actions = run(one_episode(world__wrong_items=["med_analgesic", "supp_omega3"]))
    assert record.success
    for name in ("check medication wrong", "put down medicine", "check supplement wrong", "put down supplement"):
        assert any(action.startswith(name) for action in actions), name
    assert sum(action.startswith("collect med antibiotic") for action in actions) >= 2
    assert record.mismatches >= 2
    assert record.collisions == 0


def test_a_robot_displaced_in_mid_leg_finds_its_way_and_delivers():
    episode = Episode(one_episode())
    assert episode.advance(20.0, until=lambda: episode.state()[Y] > 5.0)
    pose = episode.plant.GetFreeBodyPose(episode.plant_context, episode.base)
    pose.set_translation(pose.translation() + np.array([4.0, -1.0, 0.0]))
    episode.plant.SetFreeBodyPose(episode.plant_context, episode.base, pose)
    assert episode.advance(300.0, until=episode.finished)
    assert episode.report().success
    assert episode.read("safety_monitor", "safety")[1] == 0


def test_a_robot_carried_off_after_its_leg_is_a_mismatch_and_it_plans_from_where_it_is():
    episode = Episode(one_episode())
    arrived = lambda: episode.read("mpc_controller", "leg_report").outcome is Outcome.SUCCESS  # noqa: E731
    assert episode.advance(60.0, until=arrived)
    pose = episode.plant.GetFreeBodyPose(episode.plant_context, episode.base)
    pose.set_translation(pose.translation() + np.array([3.0, -6.0, 0.0]))
    episode.plant.SetFreeBodyPose(episode.plant_context, episode.base, pose)
    assert episode.advance(400.0, until=episode.finished)
    report = episode.report()
    assert report.success
    assert report.mismatches >= 1
    assert any("in_transit" in action for action in report.actions)


def test_a_trolley_on_the_way_that_is_not_on_the_map_is_driven_round():
    on_the_way = ObstacleConfig("trolley", 3.6, 13.0, 0.3, 0.6, 0.35)
    record, _ = run(one_episode(world__obstacles=[on_the_way]))
    assert record.success
    assert record.collisions == 0
    assert record.min_clearance_m >= 0.05


def test_a_trolley_at_the_bedside_blocks_the_leg_and_the_other_side_is_taken():
    at_the_left = ObstacleConfig("trolley", 20.5, 12.0, 0.0, 0.6, 0.5)
    record, actions = run(one_episode(world__obstacles=[at_the_left]))
    assert "blocked" in record.leg_outcomes
    assert record.success
    assert actions[-1].startswith("deliver on bedside table right")
    assert record.collisions == 0


def test_with_both_bedsides_blocked_the_episode_fails_honestly():
    both = [ObstacleConfig("left", 20.5, 12.0, 0.0, 0.6, 0.5), ObstacleConfig("right", 23.5, 10.0, 0.0, 0.5, 0.5)]
    record, _ = run(one_episode(world__obstacles=both))
    assert not record.success
    assert record.failure
    assert record.ratings == [None] * 5
    assert record.weights_after == record.weights_before
    assert record.collisions == 0


def test_a_solver_that_always_fails_ends_the_episode_in_failure_with_the_robot_standing(monkeypatch):
    episode = Episode(one_episode())
    controller, _ = episode.own("mpc_controller")
    solve = controller._solver.solve

    def failing(state, parameters, start=None):
        return solve(np.full(6, np.nan), parameters, start)

    monkeypatch.setattr(controller._solver, "solve", failing)
    assert episode.advance(120.0, until=episode.finished)
    assert not episode.report().success
    assert "solver_failure" in episode.report().failure
    assert np.abs(episode.state()[V_X : V_X + 2]).max() < 0.01


def test_a_solver_that_fails_for_a_second_costs_no_more_than_that(monkeypatch):
    episode = Episode(one_episode())
    assert episode.advance(6.0) is False
    controller, _ = episode.own("mpc_controller")
    solve, calls = controller._solver.solve, []

    def failing(state, parameters, start=None):
        calls.append(None)
        return solve(np.full(6, np.nan) if len(calls) <= 4 else state, parameters, start)

    monkeypatch.setattr(controller._solver, "solve", failing)
    assert episode.advance(60.0, until=lambda: episode.read("mpc_controller", "leg_report").finished)
    report = episode.read("mpc_controller", "leg_report")
    assert report.outcome is Outcome.SUCCESS
    assert report.failures == 4


def test_a_battery_that_empties_on_the_way_stops_the_robot_and_fails_the_episode():
    episode = Episode(one_episode())
    episode.advance(8.0)
    _, context = episode.own("battery")
    context.SetDiscreteState([0.004])
    assert episode.advance(60.0, until=episode.finished)
    assert not episode.report().success
    assert "battery" in episode.report().failure
    where = episode.state()[[X, Y]].copy()
    episode.advance(2.0)
    assert np.hypot(*(episode.state()[[X, Y]] - where)) < 0.01


def test_too_little_charge_for_any_way_is_an_unreachable_goal():
    record, actions = run(one_episode(robot__initial_charge=0.02))
    assert not record.success
    assert actions == []
    assert record.failure


def test_a_low_battery_is_charged_first():
    record, actions = run(one_episode(robot__initial_charge=0.3))
    assert record.success
    assert any(action.startswith("recharge") for action in actions)


def test_a_state_estimate_that_turns_nan_brakes_the_robot_and_is_reported():
    episode = Episode(one_episode())
    episode.advance(6.0)
    assert math.hypot(*episode.state()[V_X : V_X + 2]) > 0.5
    _, context = episode.own("state_estimator")
    for _ in range(60):
        samples = context.get_mutable_discrete_state_vector()
        samples.SetFromVector(np.full(samples.size(), np.nan))
        episode.ticks += 1
        # The estimator samples at the beginning of a tick: break its sample before the controller looks at it.
        episode.simulator.AdvanceTo((episode.ticks - 1) * TICK + SENSE_OFFSET + 0.0002)
        samples.SetFromVector(np.full(samples.size(), np.nan))
        episode.simulator.AdvanceTo(episode.ticks * TICK - 0.0005)
        if episode.read("mpc_controller", "leg_report").finished:
            break
    assert episode.read("mpc_controller", "leg_report").outcome is Outcome.INVALID_STATE
    episode.plant_context = episode.own("plant")[1]
    assert math.hypot(*episode.state()[V_X : V_X + 2]) < 0.05


def test_time_that_runs_out_fails_the_episode():
    record, _ = run(one_episode(episode_time_limit=15.0))
    assert not record.success
    assert record.failure == "the time of the episode was up"


def a_meal(**changes):
    """One meal for a patient in a hurry: a sandwich."""
    return one_episode(task="meal", control__solver="rti", **changes)


def lose(episode, box):
    """A box ends up on the floor far away, wherever it has been."""
    body = episode.plant.GetBodyByName("box", episode.plant.GetModelInstanceByName(box))
    pose = episode.plant.GetFreeBodyPose(episode.plant_context, body)
    pose.set_translation([-20.0, -20.0, 0.06])
    episode.plant.SetFreeBodyPose(episode.plant_context, body, pose)


def sell_out(episode, *boxes):
    """Somebody else takes boxes from their shelf."""
    for box in boxes:
        lose(episode, box)
    _, context = episode.own("world")
    state = context.get_mutable_abstract_state(0)
    kept = state.get_value()
    state.set_value(replace(kept, stock=tuple(name for name in kept.stock if name not in boxes)))


def acting(episode, name):
    return lambda: episode.read("task_planner", "action").name == name


@pytest.mark.slow
def test_an_ingredient_lost_on_the_way_is_fetched_again_and_all_that_was_done_is_done_anew():
    episode = Episode(a_meal())
    assert episode.advance(120.0, until=acting(episode, "go_to_quality_check"))
    lose(episode, "pantry/vegetables")
    assert episode.advance(500.0, until=episode.finished)
    report = episode.report()
    assert report.success
    assert report.mismatches >= 1
    actions = [action.strip("()").split()[0] for action in report.actions]
    assert sum(action == "(collect_ingredient robot1 pantry vegetables)" for action in report.actions) == 2
    for name in ("check_ingredients", "sanitize_workspace", "wash_ingredients", "chop_ingredients"):
        assert actions.count(name) == 2, name
    assert actions.count("choose_sandwich") == 1
    assert episode.read("safety_monitor", "safety")[1] == 0


def test_a_dish_that_is_out_of_stock_is_changed_for_another():
    episode = Episode(a_meal())
    assert episode.advance(60.0, until=acting(episode, "go_to_pantry"))
    sell_out(episode, "pantry/bread")
    assert episode.advance(120.0, until=acting(episode, "go_to_prep_station"))
    facts = episode.read("world", "world_facts").atoms
    assert ("meal_to_prepare", "robot1", "salad") in facts
    assert {atom for atom in facts if atom[0] == "missing_ingredient"} == set()
    assert ("collected_ingredient", "robot1", "nuts") in facts


def test_a_lost_ingredient_without_reserve_makes_it_another_dish():
    episode = Episode(a_meal())
    assert episode.advance(120.0, until=acting(episode, "go_to_prep_station"))
    lose(episode, "pantry/bread")
    # The kitchen is a one-way street: back to the pantry by a charger.
    assert episode.advance(60.0, until=acting(episode, "go_to_charge_main"))
    assert episode.advance(60.0, until=acting(episode, "choose_salad"))
    assert episode.advance(60.0, until=acting(episode, "go_to_pantry"))
    assert episode.advance(60.0, until=acting(episode, "collect_ingredient"))
    assert episode.read("task_planner", "action").arguments[-1] == "nuts"
    assert episode.advance(20.0, until=acting(episode, "go_to_prep_station"))
    assert episode.read("in_place_executor", "magnet").held == (("pantry/nuts", 0), ("pantry/vegetables", 1))


def test_without_vegetables_there_is_no_meal_and_no_success():
    episode = Episode(a_meal())
    assert episode.advance(60.0, until=acting(episode, "go_to_pantry"))
    sell_out(episode, "pantry/vegetables", "pantry/vegetables_2")
    assert episode.advance(120.0, until=episode.finished)
    assert not episode.report().success
    assert "no plan" in episode.report().failure


def test_a_meal_with_a_low_battery_begins_at_a_charger():
    episode = Episode(a_meal(robot__initial_charge=0.25))
    assert episode.advance(120.0, until=acting(episode, "recharge"))
    assert episode.advance(60.0, until=acting(episode, "go_to_pantry"))
    assert episode.read("battery", "charge")[0] > 0.98


@pytest.mark.slow
def test_noise_in_the_estimate_is_lived_with():
    scenario = one_episode(robot__position_noise=0.01, robot__yaw_noise=0.01, robot__velocity_noise=0.02)
    record, _ = run(scenario)
    assert record.success
    assert record.collisions == 0
