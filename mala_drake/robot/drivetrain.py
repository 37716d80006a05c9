"""The drivetrain: accelerations in, wheel torques out."""

from __future__ import annotations

from pydrake.systems.framework import BasicVector, Context, LeafSystem

from mala_drake.robot.drive_law import DriveLaw
from mala_drake.robot.plant_state import LEFT_WHEEL_SPEED, PLANT_STATE_SIZE, RIGHT_WHEEL_SPEED
from mala_drake.robot.robot_parameters import NOMINAL, RobotParameters


class Drivetrain(LeafSystem):
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
        self._law = DriveLaw(parameters)
        self._control = self.DeclareVectorInputPort("control", 3)
        self._plant_state = self.DeclareVectorInputPort("plant_state", PLANT_STATE_SIZE)
        self._charge = self.DeclareVectorInputPort("charge", 1)
        self._wheel_torques = self.DeclareVectorOutputPort(
            "wheel_torques",
            2,
            self._calc_wheel_torques,
            prerequisites_of_calc={self._control.ticket(), self._plant_state.ticket(), self._charge.ticket()},
        )
        self.DeclareVectorOutputPort(
            "power",
            1,
            self._calc_power,
            prerequisites_of_calc={self._control.ticket(), self._plant_state.ticket(), self._charge.ticket()},
        )

    def _calc_wheel_torques(self, context: Context, output: BasicVector) -> None:
        propulsion, brake, yaw_acceleration = self._control.Eval(context).tolist()
        state = self._plant_state.Eval(context)
        torques = self._law.torques(
            propulsion,
            brake,
            yaw_acceleration,
            float(state[LEFT_WHEEL_SPEED]),
            float(state[RIGHT_WHEEL_SPEED]),
            powered=self._charge.Eval(context)[0] > 0.0,
        )
        output.SetFromVector(torques)

    def _calc_power(self, context: Context, output: BasicVector) -> None:
        left, right = self._wheel_torques.Eval(context).tolist()
        state = self._plant_state.Eval(context)
        speeds = float(state[LEFT_WHEEL_SPEED]), float(state[RIGHT_WHEEL_SPEED])
        output.SetAtIndex(0, self._law.power((left, right), *speeds))
