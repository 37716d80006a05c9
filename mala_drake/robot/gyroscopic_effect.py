"""The gyroscopic effect: what the nominal model knows nothing of."""

from __future__ import annotations

import math

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from mala_drake.errors import BadInput
from mala_drake.robot.plant import CareRobot
from mala_drake.robot.plant_state import BASE_VELOCITIES, OMEGA_Z, PLANT_STATE_SIZE, V_X, V_Y, yaw_of
from mala_drake.robot.robot_parameters import NOMINAL, RobotParameters

YAW_COUPLING = 0.2
"""c at scale 1, 1/m: omega' = ... - c v_x omega. It resists the robot's turning, the more the faster it goes."""

LATERAL_COUPLING = 0.3
"""g at scale 1, dimensionless: v_y' = ... + g v_x omega. It pushes towards the inside of a curve."""


class GyroscopicEffect(LeafSystem):
    """A yaw torque and a lateral force on the base that grow with speed and yaw rate.

    .. pydrake_system::

        name: GyroscopicEffect
        input_ports:
        - plant_state
        output_ports:
        - generalized_force

    `plant_state` is the robot's own state port (see `mala_drake.robot.plant_state`). `generalized_force` has an entry
    for each velocity of the whole plant and goes to its `applied_generalized_force`, summed with others' forces.

    With the robot's nominal mass m and inertia I the torque is -c I v_x omega and the force g m v_x omega to the left:
    the coupling terms of the controller's model, whose nominal c and g are zero (paper, the model's p^f).
    """

    def __init__(
        self, plant: MultibodyPlant, robot: CareRobot, *, scale: float = 1.0, parameters: RobotParameters = NOMINAL
    ) -> None:
        """Declares the effect.

        Args:
            plant: finalized, with the robot in it.
            robot: whose base is acted on.
            scale: of both couplings; 0 switches the effect off.
            parameters: nominal mass and inertia.

        Raises:
            BadInput: the scale is not finite.
        """
        super().__init__()
        if not math.isfinite(scale):
            raise BadInput("gyroscopic effect scale", repr(scale), "a finite number")
        self._torque_gain = -scale * YAW_COUPLING * parameters.effective_yaw_inertia
        self._force_gain = scale * LATERAL_COUPLING * parameters.effective_mass
        start = robot.base.floating_velocities_start_in_v()
        self._base = slice(start, start + BASE_VELOCITIES)
        self._plant_state = self.DeclareVectorInputPort("plant_state", PLANT_STATE_SIZE)
        self.DeclareVectorOutputPort(
            "generalized_force",
            BasicVector(np.zeros(plant.num_velocities())),
            self._calc_generalized_force,
            prerequisites_of_calc={self._plant_state.ticket()},
        )

    def _calc_generalized_force(self, context: Context, output: BasicVector) -> None:
        state = self._plant_state.Eval(context).tolist()
        yaw = yaw_of(state)
        cos, sin = math.cos(yaw), math.sin(yaw)
        coupling = (cos * state[V_X] + sin * state[V_Y]) * state[OMEGA_Z]
        force = self._force_gain * coupling
        # All other entries are 0, as in the port's model vector.
        output.get_mutable_value()[self._base] = (
            0.0,
            0.0,
            self._torque_gain * coupling,
            -force * sin,
            force * cos,
            0.0,
        )
