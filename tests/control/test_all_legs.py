"""Every leg of both tasks, driven on the physical robot with its hidden truth: stopped, and clear of all."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, LogVectorOutput

from mala_drake.clock import TICK
from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.control.mpc_controller import MpcController
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.solver import MakeSolver
from mala_drake.control.solver_by_horizon import SHORTEST_HORIZON, SolverByHorizon
from mala_drake.messages import Action, ActionKind, MagnetCommand, Outcome, Preferences
from mala_drake.planning.ways import targets, ways
from mala_drake.robot.arm_kinematics import STOWED
from mala_drake.robot.drivetrain import Drivetrain
from mala_drake.robot.obstacle_sensor import ObstacleSensor
from mala_drake.robot.plant import AddCareRobot, AddFloor, MakeCarePlant, SetRobotPose
from mala_drake.robot.state_estimator import StateEstimator
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.items import TASKS
from mala_drake.ward.legs import leg_planner
from mala_drake.ward.routes import BODY_RADIUS
from mala_drake.ward.shapes import ShapeDistances
from mala_drake.ward.ward_map import LoadWard

WARD = LoadWard()
LEGS = dict.fromkeys((start.name, goal.name) for task in TASKS for start, goal in ways(WARD, task))
TARGETS = tuple(dict.fromkeys(place.name for task in TASKS for place in targets(WARD, task)))


class Drive:
    """The robot on an open floor with its controller; the ward's shapes are seen, and measured against, but not met."""

    def __init__(self, solver="snopt", *, shrinking=False):
        builder = DiagramBuilder()
        self.plant, scene_graph = MakeCarePlant(builder)
        AddFloor(self.plant)
        self.robot = AddCareRobot(self.plant, scene_graph, hidden_truth=1.0)
        self.plant.Finalize()
        congestion, problem = Congestion(WARD), OptimalControlProblem()
        guide = LegGuide(leg_planner(WARD), congestion, WARD.shapes, LegRules())
        targets = {place.name: (place.x, place.y, place.yaw) for place in WARD.places}
        make_solver = SolverByHorizon if shrinking else MakeSolver
        self.controller = builder.AddSystem(
            MpcController(
                targets=targets,
                guide=guide,
                congestion=congestion,
                problem=problem,
                solver=make_solver(solver, problem),
                shortest_horizon=SHORTEST_HORIZON if shrinking else None,
            )
        )
        drivetrain, estimator = builder.AddSystem(Drivetrain()), builder.AddSystem(StateEstimator())
        sensor = builder.AddSystem(ObstacleSensor(mapped=WARD.shapes))
        charge = builder.AddSystem(ConstantVectorSource([1.0]))
        arm = builder.AddSystem(ConstantVectorSource([*STOWED, 0.0, 0.0, 0.0]))
        base_state = self.plant.get_state_output_port(self.robot.robot)
        for source, target in (
            (base_state, drivetrain.GetInputPort("plant_state")),
            (base_state, estimator.GetInputPort("plant_state")),
            (estimator.get_output_port(), self.controller.GetInputPort("robot_state")),
            (estimator.get_output_port(), sensor.GetInputPort("robot_state")),
            (sensor.get_output_port(), self.controller.GetInputPort("obstacles")),
            (self.controller.GetOutputPort("control"), drivetrain.GetInputPort("control")),
            (charge.get_output_port(), drivetrain.GetInputPort("charge")),
            (charge.get_output_port(), self.controller.GetInputPort("charge")),
            (drivetrain.GetOutputPort("wheel_torques"), self.plant.get_actuation_input_port(self.robot.robot)),
            (arm.get_output_port(), self.plant.get_desired_state_input_port(self.robot.arm)),
        ):
            builder.Connect(source, target)
        self.log = LogVectorOutput(estimator.get_output_port(), builder, 0.05)
        self.diagram = builder.Build()

    def go(self, start, goal):
        """Drives from one place to another; returns the report and the least clearance of the body."""
        place = WARD.place[start]
        return self.go_from((place.x, place.y, place.yaw), goal, start)

    def go_from(self, pose, goal, start=""):
        """The same from any pose."""
        simulator = Simulator(self.diagram)
        context = simulator.get_mutable_context()
        plant_context = self.plant.GetMyMutableContextFromRoot(context)
        SetRobotPose(self.plant, plant_context, self.robot, x=pose[0], y=pose[1], yaw=pose[2])
        own = self.controller.GetMyMutableContextFromRoot(context)
        action = Action(1, ActionKind.MOVE, f"go_to_{goal}", (), goal, start)
        for port, value in (("action", action), ("magnet", MagnetCommand()), ("preferences", Preferences())):
            self.controller.GetInputPort(port).FixValue(own, Value(value))
        report = self.controller.GetOutputPort("leg_report")
        for tick in range(1, 600):
            simulator.AdvanceTo(tick * TICK)
            if report.Eval(own).finished:
                break
        positions = self.log.FindLog(context).data()[:2].T
        return report.Eval(own), float(ShapeDistances(WARD.shapes)(positions).min()) - BODY_RADIUS


def assert_good(report, clearance, where):
    assert report.outcome is Outcome.SUCCESS, where
    assert report.position_error <= 0.15, where
    assert report.yaw_error <= 0.2, where
    assert report.terminal_speed <= 0.05, where
    assert report.failures == report.not_converged == 0, where
    assert clearance >= 0.05, where


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["snopt", "rti"])
@pytest.mark.parametrize("goal", TARGETS)
def test_every_leg_ends_stopped_in_its_pose_and_clear_of_everything(goal, solver):
    drive = Drive(solver)
    for start, end in LEGS:
        if end == goal:
            assert_good(*drive.go(start, goal), f"{start} -> {goal}")


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["snopt", "rti"])
@pytest.mark.parametrize("goal", TARGETS)
def test_a_leg_can_begin_anywhere(goal, solver):
    """As after a mismatch: in transit between the places, looking anywhere, with the body's half width to spare."""
    generator = np.random.default_rng(TARGETS.index(goal))
    drive, distances, starts = Drive(solver), ShapeDistances(WARD.shapes), 0
    while starts < 4:
        pose = generator.uniform([-23.0, -23.0, -np.pi], [23.0, 23.0, np.pi])
        if distances(pose[:2]).min() > 1.5 * BODY_RADIUS:
            starts += 1
            assert_good(*drive.go_from(pose, goal), f"{pose} -> {goal}")


@pytest.mark.parametrize(("solver", "shrinking"), [("snopt", False), ("rti", False), ("rti", True)])
def test_a_leg_round_furniture_ends_stopped_in_its_pose(solver, shrinking):
    report, clearance = Drive(solver, shrinking=shrinking).go("supply_A", "patient_bed_left")
    assert report.outcome is Outcome.SUCCESS
    assert report.failures == report.not_converged == 0
    assert np.isfinite(report.closed_loop_cost)
    assert clearance >= 0.05
