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
from mala_drake.learning import DynamicsEstimator
from mala_drake.robot.plant import X_WB_at
from mala_drake.robot.plant_state import V_X, X, Y, planar_state_of, yaw_of
from mala_drake.scenario import DisplacedPlaceConfig, ObstacleConfig, Scenario
from mala_drake.station_context import learner_states_of

from .station_ports import read, robot_state

OURS = [
    "scheduler",
    "task_planner",
    "fuzzy_grounding",
    "mpc_controller",
    "in_place_executor",
    "world",
    "obstacle_sensor",
    "feature_meter",
    "action_meter",
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


@pytest.mark.parametrize("name", OURS)
def test_every_system_has_the_ports_it_draws(station, name, assert_port_box):
    assert_port_box(station.GetSubsystemByName(name))


def open_inputs(station, names):
    connected = {(target[0].get_name(), target[1]) for target in station.connection_map()}
    systems = [station.GetSubsystemByName(name) for name in names]
    ports = [system.get_input_port(i) for system in systems for i in range(system.num_input_ports())]
    return [
        (port.get_system().get_name(), port.get_name())
        for port in ports
        if (port.get_system().get_name(), port.get_index()) not in connected
    ]


def test_every_input_of_our_systems_is_connected_but_those_of_what_nobody_learns(station):
    learned = ("learned_targets", "learned_dynamics", "learned_weights")
    assert open_inputs(station, OURS) == [("mpc_controller", name) for name in learned]


def test_the_noise_of_the_estimate_is_not_measured_as_driving():
    scenario = Scenario(task="medication")
    scenario.robot.position_noise, scenario.robot.yaw_noise = 0.1, 0.1
    scenario.robot.initial_charge = 0.0  # It stands where it is.
    station = mut.MakeCareStation(scenario)
    simulator = Simulator(station)
    simulator.AdvanceTo(1.0)
    context = simulator.get_context()
    time, safety, *_ = read(station, context, "feature_meter", "features")
    assert time > 0.0
    assert safety < 1e-6
    assert np.hypot(*(read(station, context, "state_estimator", "robot_state")[:2])) > 0.01


def displaced(**control):
    scenario = Scenario(task="meal")
    scenario.world.displaced_places = [DisplacedPlaceConfig("pantry", -0.5, 1.9)]
    for name, value in control.items():
        setattr(scenario.control, name, value)
    return scenario


def test_the_target_learner_is_there_when_it_is_wanted(assert_port_box):
    station = mut.MakeCareStation(displaced(learned_targets=True))
    assert ("mpc_controller", "learned_targets") not in open_inputs(station, OURS)
    names = ("learned_dynamics", "learned_weights")
    assert open_inputs(station, ["target_learner"]) == [("target_learner", name) for name in names]
    assert_port_box(station.GetSubsystemByName("target_learner"))
    assert "target_learner" in learner_states_of(station, station.CreateDefaultContext())


def test_the_dynamics_learner_is_there_when_it_is_wanted(assert_port_box):
    scenario = Scenario()
    scenario.control.learned_dynamics = True
    station = mut.MakeCareStation(scenario)
    assert ("mpc_controller", "learned_dynamics") not in open_inputs(station, OURS)
    assert open_inputs(station, ["dynamics_learner"]) == []
    assert_port_box(station.GetSubsystemByName("dynamics_learner"))
    states = learner_states_of(station, station.CreateDefaultContext())
    assert states["dynamics_learner"] == pytest.approx(DynamicsEstimator().initial_state())


@pytest.mark.parametrize(("weights", "translation", "size"), [(True, False, 0), (False, True, 46), (True, True, 46)])
def test_the_weight_learner_is_there_when_it_is_wanted(assert_port_box, weights, translation, size):
    scenario = Scenario()
    scenario.control.learned_weights, scenario.control.learned_translation = weights, translation
    station = mut.MakeCareStation(scenario)
    assert ("mpc_controller", "learned_weights") not in open_inputs(station, OURS)
    names = ("learned_dynamics", "learned_targets")
    assert open_inputs(station, ["weight_learner"]) == [("weight_learner", name) for name in names]
    assert_port_box(station.GetSubsystemByName("weight_learner"))
    state = learner_states_of(station, station.CreateDefaultContext())["weight_learner"]
    assert state.size == size + weights * 11 * len(scenario.load_ward().places)


def test_the_learners_of_the_controller_listen_to_each_other():
    scenario = displaced(learned_targets=True, learned_dynamics=True, learned_weights=True, learned_translation=True)
    station = mut.MakeCareStation(scenario)
    learners = ["target_learner", "dynamics_learner", "weight_learner"]
    assert open_inputs(station, [*OURS, *learners]) == []


def test_the_controllers_solver_is_the_one_of_the_scenario():
    scenario = Scenario()
    scenario.control.solver, scenario.control.tolerance, scenario.control.hard_clearance = "snopt", 1e-3, True
    solver = mut.MakeCareStation(scenario).GetSubsystemByName("mpc_controller")._solver
    assert (solver.name, solver._tolerance, solver._hard_clearance) == ("snopt", 1e-3, True)
    scenario.control.solver, scenario.control.qp_solver, scenario.control.sqp_iterations = "rti", "clarabel", 3
    solver = mut.MakeCareStation(scenario).GetSubsystemByName("mpc_controller")._solver
    tools = solver._tools
    assert (tools.tolerance, tools.hard_clearance, tools.qp_solver.name) == (1e-3, True, "clarabel")
    assert solver._sqp_iterations == 3


def test_a_displaced_place_is_elsewhere_than_the_robot_believes():
    station = mut.MakeCareStation(displaced())
    inspector = station.GetSubsystemByName("scene_graph").model_inspector()
    plant = station.GetSubsystemByName("plant")
    shelf = [g for g in inspector.GetAllGeometryIds() if "pantry_shelf/" in inspector.GetName(g)]
    assert shelf
    centre = np.mean([inspector.GetPoseInFrame(geometry).translation()[:2] for geometry in shelf], axis=0)
    assert centre == pytest.approx([-1.7 - 0.5, 15.0 + 1.9], abs=0.5)
    # At home the robot is far from both; it begins where the map says that the pantry is, then where it is.
    for x, y, expected in ((0.0, 0.0, 0.0), (-3.0, 15.0, (5.0 - 1.965) / 4.0), (-3.5, 16.9, 1.0)):
        context = station.CreateDefaultContext()
        base = plant.get_body(min(plant.GetFloatingBaseBodies(), key=int))
        plant.SetFloatingBaseBodyPoseInWorldFrame(plant.GetMyMutableContextFromRoot(context), base, X_WB_at(x, y, 0.0))
        Simulator(station, context).AdvanceTo(PLANT_STEP)
        memberships = read(station, context, "fuzzy_grounding", "memberships")
        assert memberships.value(("at", "robot1", "pantry")) == pytest.approx(expected, abs=0.01)


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


def test_every_tick_is_sampled_just_after_the_plants_step(station):
    simulator = Simulator(station)
    context = simulator.get_mutable_context()
    for tick in range(100):
        simulator.AdvanceTo(tick * TICK + 0.5 * PLANT_STEP)
        sampled = read(station, context, "state_estimator", "robot_state")
        assert sampled == pytest.approx(planar_state_of(robot_state(station, context).tolist()), abs=1e-12)


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
