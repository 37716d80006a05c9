"""Fixtures of the robot's tests: a robot on a flat floor with its drivetrain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pytest
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, FixedInputPortValue
from pydrake.systems.primitives import ConstantVectorSource

from mala_drake.robot.arm_kinematics import STOWED
from mala_drake.robot.drivetrain import Drivetrain
from mala_drake.robot.plant import AddCareRobot, AddFloor, CareRobot, MakeCarePlant
from mala_drake.robot.plant_state import planar_state_of


@dataclass
class Bench:
    """A robot standing at the origin of an empty floor, its control in the test's hands."""

    diagram: Diagram
    plant: MultibodyPlant
    robot: CareRobot
    simulator: Simulator
    control: FixedInputPortValue
    charge: FixedInputPortValue

    @property
    def context(self) -> Context:
        return self.simulator.get_mutable_context()

    @property
    def plant_context(self) -> Context:
        return self.plant.GetMyMutableContextFromRoot(self.context)

    def drive(self, propulsion: float, brake: float, yaw_acceleration: float, *, seconds: float) -> None:
        self.control.GetMutableData().get_mutable_value().SetFromVector([propulsion, brake, yaw_acceleration])
        self.simulator.AdvanceTo(self.context.get_time() + seconds)

    def plant_state(self) -> list[float]:
        return self.plant.get_state_output_port(self.robot.robot).Eval(self.plant_context).tolist()

    def state(self) -> tuple[float, ...]:
        return planar_state_of(self.plant_state())


@pytest.fixture
def make_bench() -> Callable[..., Bench]:
    """Builds a `Bench`; `add` may put more into the plant, `wire` more systems beside it."""

    def make(
        *,
        hidden_truth: float = 0.0,
        add: Callable[..., None] | None = None,
        wire: Callable[..., None] | None = None,
    ) -> Bench:
        builder = DiagramBuilder()
        plant, scene_graph = MakeCarePlant(builder)
        robot = AddCareRobot(plant, scene_graph, hidden_truth=hidden_truth)
        AddFloor(plant)
        if add is not None:
            add(plant, scene_graph, robot)
        plant.Finalize()
        drivetrain = builder.AddNamedSystem("drivetrain", Drivetrain())
        builder.Connect(plant.get_state_output_port(robot.robot), drivetrain.GetInputPort("plant_state"))
        builder.Connect(drivetrain.GetOutputPort("wheel_torques"), plant.get_actuation_input_port(robot.robot))
        if wire is not None:
            wire(builder, plant, robot, drivetrain)
        if not builder.IsConnectedOrExported(plant.get_desired_state_input_port(robot.arm)):
            stow = builder.AddSystem(ConstantVectorSource([*STOWED, 0.0, 0.0, 0.0]))
            builder.Connect(stow.get_output_port(), plant.get_desired_state_input_port(robot.arm))
        builder.ExportInput(drivetrain.GetInputPort("control"), "control")
        if not builder.IsConnectedOrExported(drivetrain.GetInputPort("charge")):
            builder.ExportInput(drivetrain.GetInputPort("charge"), "charge")
        diagram = builder.Build()
        simulator = Simulator(diagram)
        context = simulator.get_mutable_context()
        control = diagram.GetInputPort("control").FixValue(context, [0.0, 2.0, 0.0])
        charge = diagram.GetInputPort("charge").FixValue(context, [1.0]) if diagram.HasInputPort("charge") else None
        return Bench(diagram, plant, robot, simulator, control, charge)

    return make
