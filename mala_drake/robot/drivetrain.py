"""The drivetrain: accelerations in, wheel torques out."""

from __future__ import annotations

from pydrake.systems.framework import BasicVector, Context, Diagram, DiagramBuilder, LeafSystem
from pydrake.systems.primitives import Demultiplexer

from mala_drake.robot.drive_law import DriveLaw
from mala_drake.robot.plant_state import LEFT_WHEEL_SPEED, PLANT_STATE_SIZE, RIGHT_WHEEL_SPEED
from mala_drake.robot.robot_parameters import NOMINAL, RobotParameters


class Drivetrain(Diagram):
    """Turns propulsion, brake and yaw commands into the torques of two wheels, at the rate of the plant.

    .. pydrake_system::

        name: Drivetrain
        input_ports:
        - control
        - plant_state
        - charge
        output_ports:
        - wheel_torques
        - power

    `control` is [propulsion, m/s^2; brake >= 0, m/s^2; yaw acceleration, rad/s^2], each held to its limit.
    `plant_state` is the robot's own state port (see `mala_drake.robot.plant_state`); `charge` is the battery's.
    `wheel_torques` are those of the left and the right wheel, N m; `power` is what they draw, W.

    The brake is passive: it acts on the motion of the moment, so that a command held over a control period never pushes
    the robot backward. At charge 0, or when the control is not finite, the robot brakes and stands.
    """

    def __init__(self, *, parameters: RobotParameters = NOMINAL) -> None:
        super().__init__()
        builder = DiagramBuilder()
        # Torques and power are computed together, once a step of the plant, and then taken apart.
        wheels = builder.AddNamedSystem("wheels", _Wheels(DriveLaw(parameters)))
        drive = builder.AddNamedSystem("drive", Demultiplexer([2, 1]))
        builder.Connect(wheels.get_output_port(), drive.get_input_port())
        for name in ("control", "plant_state", "charge"):
            builder.ExportInput(wheels.GetInputPort(name), name)
        builder.ExportOutput(drive.get_output_port(0), "wheel_torques")
        builder.ExportOutput(drive.get_output_port(1), "power")
        builder.BuildInto(self)


class _Wheels(LeafSystem):
    """The torques of both wheels and the power of the drive in one vector of three."""

    def __init__(self, law: DriveLaw) -> None:
        super().__init__()
        self._law = law
        self._control = self.DeclareVectorInputPort("control", 3)
        self._plant_state = self.DeclareVectorInputPort("plant_state", PLANT_STATE_SIZE)
        self._charge = self.DeclareVectorInputPort("charge", 1)
        inputs = {self._control.ticket(), self._plant_state.ticket(), self._charge.ticket()}
        self.DeclareVectorOutputPort("drive", 3, self._calc_drive, prerequisites_of_calc=inputs)

    def _calc_drive(self, context: Context, output: BasicVector) -> None:
        propulsion, brake, yaw_acceleration = self._control.Eval(context).tolist()
        state = self._plant_state.Eval(context)
        speeds = state.item(LEFT_WHEEL_SPEED), state.item(RIGHT_WHEEL_SPEED)
        powered = self._charge.Eval(context).item() > 0.0
        torques = self._law.torques(propulsion, brake, yaw_acceleration, *speeds, powered=powered)
        output.SetFromVector([*torques, self._law.power(torques, *speeds)])
