"""How fast the physics runs: the robot on a flat floor, with and without each of its systems.

The robot coasts in a wide curve with every box of the ward clamped in the air. What a system costs is the difference to
the row without it; differences of a millisecond are noise.
"""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from typing import Any

from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder, InputPort, OutputPort
from pydrake.systems.primitives import Adder, ConstantValueSource, ConstantVectorSource

from mala_drake.clock import TICK
from mala_drake.messages import ArmCommand, MagnetCommand, Message
from mala_drake.robot.arm import Arm
from mala_drake.robot.arm_kinematics import PAD_RADIUS, STOWED, pad_position
from mala_drake.robot.battery import Battery
from mala_drake.robot.drivetrain import Drivetrain
from mala_drake.robot.gyroscopic_effect import GyroscopicEffect
from mala_drake.robot.item_messages import ClampedItems
from mala_drake.robot.items import AddItems, ItemBodies
from mala_drake.robot.magnet import Magnet
from mala_drake.robot.plant import AddCareRobot, AddFloor, MakeCarePlant
from mala_drake.robot.robot_parameters import NOMINAL
from mala_drake.robot.safety_monitor import SafetyMonitor
from mala_drake.robot.sleeping_boxes import SleepingBoxes
from mala_drake.robot.state_estimator import StateEstimator
from mala_drake.ward.items import ITEM_HALF_HEIGHT, Item, all_items
from mala_drake.ward.ward_map import LoadWard

SYSTEMS = ("drivetrain", "arm", "battery", "gyroscopic_effect", "magnet", "safety_monitor", "state_estimator")
"""What can be left out; without the magnet the boxes are left out too, for nothing would hold them."""

_SPEED, _YAW_RATE = 1.2, 0.3  # Of the curve, m/s and rad/s.


def bench_plant(*, seconds: float = 10.0, repetitions: int = 3) -> list[dict[str, Any]]:
    """Milliseconds for one simulated second, a row a configuration.

    Args:
        seconds: simulated, for each measurement.
        repetitions: measurements of each configuration, of which the fastest counts.
    """
    rigs = {"robot alone": _Rig(()), "all systems": _Rig(SYSTEMS)}
    for name in SYSTEMS:
        rigs[f"all but {name}"] = _Rig([other for other in SYSTEMS if other != name])
    rigs["all, two boxes carried"] = _Rig(SYSTEMS, carried=2)
    rigs["all, boxes asleep"] = _Rig(SYSTEMS, sleep=True)
    rigs["all, boxes of a meal"] = _Rig(SYSTEMS, tasks=("meal",))
    rigs["all, boxes of both tasks"] = _Rig(SYSTEMS, tasks=("medication", "meal"))
    rigs["all, boxes of both tasks asleep"] = _Rig(SYSTEMS, tasks=("medication", "meal"), sleep=True)
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in rigs}
    for _ in range(repetitions):
        # In turn, so that a busy minute of the machine falls on all of them alike.
        for name, rig in rigs.items():
            times[name].append(_measure(rig, seconds))
    return [_row(name, measured) for name, measured in times.items()]


def _row(name: str, measured: Sequence[tuple[float, float]]) -> dict[str, Any]:
    walls, processors = zip(*measured, strict=True)
    return {
        "configuration": name,
        "wall_ms_per_s": round(min(walls), 2),
        "processor_ms_per_s": round(min(processors), 2),
    }


class _Rig:
    """A robot on a flat floor with some of its systems; what the others would send is constant."""

    def __init__(
        self,
        systems: Collection[str],
        *,
        carried: int = 0,
        tasks: Collection[str] = ("medication",),
        sleep: bool = False,
    ) -> None:
        """Builds it with the boxes of some tasks, some of them carried, the others asleep or awake."""
        items = all_items(LoadWard(), tasks) if "magnet" in systems else ()
        self._clamped = ClampedItems(tuple((item.name, item.shelf_pose) for item in items[carried:]))
        self._sleep = sleep
        self._builder = DiagramBuilder()
        self._plant, self._scene_graph = MakeCarePlant(self._builder)
        self._robot = AddCareRobot(self._plant, self._scene_graph, visible=False)
        AddFloor(self._plant)
        bodies = AddItems(self._plant, self._scene_graph, items, self._robot, visible=False)
        self._bodies = bodies.bodies
        self._carried = bodies.bodies[:carried]
        self._plant.Finalize()
        self._plant_state = self._plant.get_state_output_port(self._robot.robot)
        self._add_drive(systems)
        self._add_arm(systems)
        self._add_forces(systems, bodies, items, carried)
        self._add_sensors(systems)
        self.diagram = self._builder.Build()

    def start(self) -> Simulator:
        """A simulator with the robot in its curve, and what it carries at its pads."""
        simulator = Simulator(self.diagram)
        context = self._plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        spins = [(_SPEED + side * NOMINAL.half_track * _YAW_RATE) / NOMINAL.wheel_radius for side in (-1.0, 1.0)]
        velocities = [0.0, 0.0, _YAW_RATE, _SPEED, 0.0, 0.0, *spins]
        self._plant.SetVelocities(context, self._robot.robot, velocities)
        for pad, body in enumerate(self._carried):
            x, y, z = pad_position(STOWED, pad)
            pose = [1.0, 0.0, 0.0, 0.0, x, y, z - PAD_RADIUS - ITEM_HALF_HEIGHT]
            velocity = [0.0, 0.0, _YAW_RATE, _SPEED - _YAW_RATE * y, _YAW_RATE * x, 0.0]
            self._plant.SetPositions(context, body.model_instance(), pose)
            self._plant.SetVelocities(context, body.model_instance(), velocity)
        simulator.Initialize()
        return simulator

    def advance(self, simulator: Simulator, seconds: float) -> None:
        """Simulates as a run does, tick by tick."""
        context = simulator.get_mutable_context()
        boxes = SleepingBoxes(
            self._plant, self._scene_graph, self._robot.base, self._bodies, lambda: self._clamped, context
        )
        for tick in range(1, max(1, round(seconds / TICK)) + 1):
            if self._sleep:
                boxes.update()
            simulator.AdvanceTo(min(tick * TICK, seconds))

    def _add_drive(self, systems: Collection[str]) -> None:
        if "drivetrain" not in systems:
            self._feed(self._plant.get_actuation_input_port(self._robot.robot), [0.0, 0.0])
            return
        drivetrain = self._builder.AddSystem(Drivetrain())
        self._connect(self._plant_state, drivetrain.GetInputPort("plant_state"))
        self._connect(
            drivetrain.GetOutputPort("wheel_torques"), self._plant.get_actuation_input_port(self._robot.robot)
        )
        self._feed(drivetrain.GetInputPort("control"), [0.0, 0.0, 0.0])
        if "battery" not in systems:
            self._feed(drivetrain.GetInputPort("charge"), [1.0])
            return
        battery = self._builder.AddSystem(Battery())
        self._connect(drivetrain.GetOutputPort("power"), battery.GetInputPort("power"))
        self._connect(battery.GetOutputPort("charge"), drivetrain.GetInputPort("charge"))
        self._feed(battery.GetInputPort("charge_rates"), [0.0, 0.0])

    def _add_arm(self, systems: Collection[str]) -> None:
        desired_state = self._plant.get_desired_state_input_port(self._robot.arm)
        if "arm" not in systems:
            self._feed(desired_state, [*STOWED, 0.0, 0.0, 0.0])
            return
        arm = self._builder.AddSystem(Arm())
        self._connect(arm.GetOutputPort("desired_state"), desired_state)
        self._feed(arm.GetInputPort("arm_target"), ArmCommand())

    def _add_forces(self, systems: Collection[str], bodies: ItemBodies, items: Sequence[Item], carried: int) -> None:
        forces = []
        if "gyroscopic_effect" in systems:
            effect = self._builder.AddSystem(GyroscopicEffect(self._plant, self._robot))
            self._connect(self._plant_state, effect.GetInputPort("plant_state"))
            forces.append(effect.get_output_port())
        if "magnet" in systems:
            magnet = self._builder.AddSystem(Magnet(self._plant, self._robot, bodies))
            self._connect(self._plant.get_state_output_port(), magnet.GetInputPort("state"))
            held = tuple((item.name, pad) for pad, item in enumerate(items[:carried]))
            self._feed(magnet.GetInputPort("magnet"), MagnetCommand(held))
            self._feed(magnet.GetInputPort("clamped"), self._clamped)
            forces.append(magnet.get_output_port())
        if forces:
            adder = self._builder.AddSystem(Adder(len(forces), self._plant.num_velocities()))
            for i, force in enumerate(forces):
                self._connect(force, adder.get_input_port(i))
            self._connect(adder.get_output_port(), self._plant.get_applied_generalized_force_input_port())

    def _add_sensors(self, systems: Collection[str]) -> None:
        if "safety_monitor" in systems:
            monitor = self._builder.AddSystem(SafetyMonitor(self._robot, LoadWard().shapes))
            self._connect(self._plant_state, monitor.GetInputPort("plant_state"))
            self._connect(self._plant.get_contact_results_output_port(), monitor.GetInputPort("contact_results"))
        if "state_estimator" in systems:
            estimator = self._builder.AddSystem(StateEstimator())
            self._connect(self._plant_state, estimator.GetInputPort("plant_state"))

    def _connect(self, output_port: OutputPort, input_port: InputPort) -> None:
        self._builder.Connect(output_port, input_port)

    def _feed(self, port: InputPort, value: Sequence[float] | Message) -> None:
        """Connects a constant to an input port."""
        if isinstance(value, Message):
            source = self._builder.AddSystem(ConstantValueSource(Value(value)))
        else:
            source = self._builder.AddSystem(ConstantVectorSource(value))
        self._connect(source.get_output_port(), port)


def _measure(rig: _Rig, seconds: float) -> tuple[float, float]:
    """Wall and processor time, milliseconds for one simulated second."""
    simulator = rig.start()
    wall, processor = time.perf_counter(), time.process_time()
    rig.advance(simulator, seconds)
    scale = 1e3 / seconds
    return scale * (time.perf_counter() - wall), scale * (time.process_time() - processor)
