"""World, executor, arm and magnet together on the plant, the robot set before one place after another."""

import math

from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from mala_drake.messages import Action, ActionKind, Task
from mala_drake.robot.arm import Arm
from mala_drake.robot.arm_kinematics import PAD_OFFSETS
from mala_drake.robot.battery import Battery
from mala_drake.robot.drivetrain import Drivetrain
from mala_drake.robot.gripper_geometry import HANGING_DEPTH
from mala_drake.robot.in_place_executor import InPlaceExecutor
from mala_drake.robot.item_positions import ItemPositions
from mala_drake.robot.items import AddItems
from mala_drake.robot.magnet import Magnet
from mala_drake.robot.plant import AddCareRobot, MakeCarePlant, SetRobotPose, X_WB_at
from mala_drake.robot.state_estimator import StateEstimator
from mala_drake.robot.ward_plant import AddWard
from mala_drake.robot.world import World
from mala_drake.ward.items import all_items
from mala_drake.ward.ward_map import LoadWard


class Stage:
    """The robot among the furniture it handles boxes at, set before one place after another by the test."""

    def __init__(self, **options):
        self.ward = LoadWard()
        self.task = options.pop("task", "medication")
        self.kept = all_items(self.ward, (self.task,))
        builder = DiagramBuilder()
        self.plant, scene_graph = MakeCarePlant(builder)
        self.robot = AddCareRobot(self.plant, scene_graph)
        AddWard(self.plant, self.ward, visible=False)
        self.items = AddItems(self.plant, scene_graph, self.kept, self.robot)
        self.plant.Finalize()
        self._wire(builder, options)
        self.diagram = builder.Build()
        self.simulator = Simulator(self.diagram)
        self.context = self.simulator.get_mutable_context()
        self.plant_context = self.plant.GetMyMutableContextFromRoot(self.context)
        self.diagram.GetInputPort("control").FixValue(self.context, [0.0, 2.0, 0.0])
        self.diagram.GetInputPort("task").FixValue(self.context, Value(Task(1, self.task)))
        self.action = self.diagram.GetInputPort("action").FixValue(self.context, Value(Action()))
        self.sequence, self.place = 0, ""

    def _wire(self, builder, options):
        self.world = World(self.ward, items=self.kept, **options)
        self.executor = InPlaceExecutor(self.ward, items=self.kept)
        self.battery = Battery(initial_charge=0.9)
        systems = [
            *(self.world, self.executor, self.battery, Drivetrain(), StateEstimator(), Arm()),
            Magnet(self.plant, self.robot, self.items),
            ItemPositions(self.plant, self.items),
        ]
        for system in systems:
            builder.AddSystem(system)
        ports = {
            "plant_state": self.plant.get_state_output_port(self.robot.robot),
            "arm_state": self.plant.get_state_output_port(self.robot.arm),
            "state": self.plant.get_state_output_port(),
        }
        for system in systems:
            for i in range(system.num_output_ports()):
                ports[system.get_output_port(i).get_name()] = system.get_output_port(i)
        for system in systems:
            for i in range(system.num_input_ports()):
                port = system.get_input_port(i)
                if port.get_name() in ports:
                    builder.Connect(ports[port.get_name()], port)
        builder.Connect(ports["wheel_torques"], self.plant.get_actuation_input_port(self.robot.robot))
        builder.Connect(ports["desired_state"], self.plant.get_desired_state_input_port(self.robot.arm))
        builder.Connect(ports["generalized_force"], self.plant.get_applied_generalized_force_input_port())
        builder.ExportInput(systems[3].GetInputPort("control"), "control")
        builder.ExportInput(self.world.GetInputPort("task"), "task")
        builder.ExportInput(self.world.GetInputPort("action"), "action")
        builder.ConnectInput("action", self.executor.GetInputPort("action"))

    def output(self, system, name):
        return system.GetOutputPort(name).Eval(system.GetMyContextFromRoot(self.context))

    def stand_at(self, place, ahead=0.0, aside=0.0, turn=0.0):
        """Sets the robot, with what hangs at it, before a place, off its standing pose by that much."""
        here, self.place = self.ward.place[place], place
        cosine, sine = math.cos(here.yaw), math.sin(here.yaw)
        x, y = here.x + ahead * cosine - aside * sine, here.y + ahead * sine + aside * cosine
        X_BW = self.plant.GetFreeBodyPose(self.plant_context, self.robot.base).inverse()
        X_WB = X_WB_at(x, y, here.yaw + turn)
        for item, _ in self.output(self.executor, "magnet").held:
            body = self.items.body(item)
            X_BI = X_BW @ self.plant.GetFreeBodyPose(self.plant_context, body)
            self.plant.SetFreeBodyPose(self.plant_context, body, X_WB @ X_BI)
        SetRobotPose(self.plant, self.plant_context, self.robot, x=x, y=y, yaw=here.yaw + turn)
        self.simulator.AdvanceTo(self.context.get_time() + 0.4)

    def do(self, name, *arguments):
        """What became of an in-place action, and how long it took."""
        self.sequence += 1
        action = Action(self.sequence, ActionKind.IN_PLACE, name, ("robot1", *arguments), self.place, self.place)
        self.action.GetMutableData().set_value(action)
        begun = self.context.get_time()
        while self.context.get_time() - begun < 60.0:
            self.simulator.AdvanceTo(self.context.get_time() + 0.2)
            report = self.output(self.executor, "in_place_report")
            if report.finished and report.sequence == self.sequence:
                break
        seconds = self.context.get_time() - begun
        self.simulator.AdvanceTo(self.context.get_time() + 0.2)
        return report.outcome, seconds

    def facts(self):
        atoms = self.output(self.world, "world_facts").atoms
        return {atom[0] for atom in atoms if atom[0] != "available"}

    def hanging(self, pad):
        """Where a box at that pad belongs, by the real pose of the gripper."""
        X_WG = self.robot.gripper.CalcPoseInWorld(self.plant_context)
        bar = self.plant.GetBodyByName("base", self.robot.robot).EvalPoseInWorld(self.plant_context).rotation()
        yaw = self.plant.get_state_output_port(self.robot.arm).Eval(self.plant_context)[0]
        along = bar.multiply([-PAD_OFFSETS[pad] * math.sin(yaw), PAD_OFFSETS[pad] * math.cos(yaw), 0.0])
        return X_WG.translation() + along - [0.0, 0.0, HANGING_DEPTH]

    def position(self, item):
        return self.plant.GetFreeBodyPose(self.plant_context, self.items.body(item)).translation()
