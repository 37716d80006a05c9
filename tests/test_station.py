"""The station as a diagram like any other: its wiring, its ports, and a short closed loop of all layers."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import PortDataType

from mala_drake import station as mut
from mala_drake.clock import PLANT_STEP, TICK
from mala_drake.errors import BadInput
from mala_drake.learning import Posterior
from mala_drake.robot.plant_state import V_X, X, Y, yaw_of
from mala_drake.scenario import ObstacleConfig, Scenario

OURS = [
    "scheduler",
    "task_planner",
    "fuzzy_grounding",
    "mpc_controller",
    "in_place_executor",
    "world",
    "obstacle_sensor",
    "feature_meter",
    "state_estimator",
    "safety_monitor",
    "item_positions",
    "drivetrain",
    "arm",
    "magnet",
    "battery",
    "gyroscopic_effect",
    "patient",
    "preference_learner",
    "cost_learner",
]


@pytest.fixture(scope="module")
def station():
    return mut.MakeCareStation(Scenario())


def read(station, context, system, port):
    subsystem = station.GetSubsystemByName(system)
    return subsystem.GetOutputPort(port).Eval(subsystem.GetMyContextFromRoot(context))


def robot_state(station, context):
    return read(station, context, "plant", "care_robot_state")


@pytest.mark.parametrize("name", OURS)
def test_every_system_has_the_ports_it_draws(station, name, assert_port_box):
    assert_port_box(station.GetSubsystemByName(name))


def test_every_input_of_our_systems_is_connected(station):
    connected = {(target[0].get_name(), target[1]) for target in station.connection_map()}
    for name in OURS:
        system = station.GetSubsystemByName(name)
        for i in range(system.num_input_ports()):
            port = system.get_input_port(i)
            assert (name, port.get_index()) in connected, f"{name}.{port.get_name()}"


def test_the_layers_are_those_of_the_design(station):
    names = {system.get_name() for system in station.GetSystems()}
    assert set(OURS) | {"plant", "scene_graph"} <= names


def test_a_plain_simulator_runs_it_and_the_robot_drives_off_home(station):
    simulator = Simulator(station)
    context = simulator.get_mutable_context()
    start = robot_state(station, context)[[X, Y]].copy()
    assert start == pytest.approx([0.0, 0.0])
    simulator.AdvanceTo(8.0)
    assert read(station, context, "task_planner", "action").name.startswith("go_to")
    assert read(station, context, "task_planner", "plan").status == "optimal"
    assert np.hypot(*(robot_state(station, context)[[X, Y]] - start)) > 3.0
    assert read(station, context, "battery", "charge")[0] < 1.0
    assert read(station, context, "safety_monitor", "safety")[1] == 0


def test_the_robot_moves_continuously_and_where_its_wheels_take_it(station):
    simulator = Simulator(station)
    context = simulator.get_mutable_context()
    before = robot_state(station, context).copy()
    for step in range(1, 600):
        simulator.AdvanceTo(step * PLANT_STEP)
        now = robot_state(station, context).copy()
        moved = np.hypot(*(now[[X, Y]] - before[[X, Y]]))
        assert moved <= 2.0 * PLANT_STEP
        along = np.array([np.cos(yaw_of(now)), np.sin(yaw_of(now))])
        sideways = abs(now[V_X] * along[1] - now[V_X + 1] * along[0])
        assert sideways < 0.05
        before = now


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


def test_abstract_ports_carry_immutable_messages(station):
    for name in ("task_planner", "mpc_controller", "world", "in_place_executor", "fuzzy_grounding"):
        system = station.GetSubsystemByName(name)
        for i in range(system.num_output_ports()):
            port = system.get_output_port(i)
            if port.get_data_type() == PortDataType.kAbstractValued:
                message = port.Allocate().get_value()
                assert message.__class__.__dataclass_params__.frozen


def test_an_obstacle_of_the_scenario_is_solid_and_unknown_to_the_map():
    scenario = Scenario()
    scenario.world.obstacles = [ObstacleConfig("crate", 5.0, 0.0)]
    station = mut.MakeCareStation(scenario)
    inspector = station.GetSubsystemByName("scene_graph").model_inspector()
    names = [inspector.GetName(geometry) for geometry in inspector.GetAllGeometryIds()]
    assert any("crate" in name for name in names)
    assert "crate" not in [shape.name for shape in scenario.load_ward().shapes]


def test_it_can_be_watched():
    station = mut.MakeCareStation(Scenario(), meshcat=Meshcat())
    assert any("meshcat" in system.get_name() for system in station.GetSystems())


def test_a_scenario_that_cannot_be_simulated_is_refused():
    scenario = Scenario(episodes=0)
    with pytest.raises(BadInput, match="episodes"):
        mut.MakeCareStation(scenario)
