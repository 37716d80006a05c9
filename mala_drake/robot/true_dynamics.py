"""What the coefficients of the controller's model really are: the truth that its learner can be measured by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from mala_drake.clock import PLANT_STEP
from mala_drake.robot.arm_kinematics import STOWED, pad_position
from mala_drake.robot.gyroscopic_effect import YAW_COUPLING
from mala_drake.robot.hidden_truth import WHEEL_RADIUS_ERRORS
from mala_drake.robot.items import ITEM_MASS
from mala_drake.robot.plant import AddCareRobot, AddFloor, MakeCarePlant
from mala_drake.robot.robot_parameters import NOMINAL

_SETTLED = 1.0  # Seconds after which the robot stands still on its wheels and a caster.


@dataclass(frozen=True, slots=True)
class TrueDynamics:
    """Coefficients of the model, as the plant's robot has them when it drives: with its arm stowed."""

    yaw_coupling: float  # c, 1/m.
    propulsion_gain: float
    brake_gain: float
    yaw_gain: float
    lateral_slip: (
        float  # g / k, seconds: v_y over v_x omega. The wheels hold the robot; g and k alone are nothing real.
    )


def true_dynamics(*, hidden_truth: float, gyroscopic_effect: float, boxes: int = 0) -> TrueDynamics:
    """The coefficients by Newton and Euler, from the masses and the inertias that the plant has.

    With force F and torque T of the wheels, m_e v' = F and I_e omega' + m d v omega = T: a centre of mass that is d
    ahead of the axle is carried round by it. The drivetrain computes F and T with the nominal mass, inertia and radius,
    and so does the gyroscopic effect. What drags or rocks is not in it: of a command that is held on an empty floor, 1
    or 2 parts in a hundred are lost on the casters.

    The wheels let nothing slip sideways. What is measured as slip comes from the plant's step, which finds velocities
    first and turns the heading after that: the lateral velocity is one of a step ago.

    Args:
        hidden_truth: scale of the errors of mass and wheel radii.
        gyroscopic_effect: scale of the coupling.
        boxes: how many of them hang from the gripper, 0 to 2. They are counted as points.

    Raises:
        BadInput: the scale of the errors is no robot's.
    """
    inertia = _inertia_at_rest(hidden_truth)
    radii = NOMINAL.wheel_radius * (1.0 + hidden_truth * np.array(list(WHEEL_RADIUS_ERRORS.values())))
    spinning = NOMINAL.wheel_inertia * float(np.sum(1.0 / radii**2))
    pads = np.array([pad_position(STOWED, pad)[:2] for pad in range(boxes)]).reshape(boxes, 2)
    mass = inertia.get_mass() + boxes * ITEM_MASS
    ahead = inertia.get_mass() * float(inertia.get_com()[0]) + ITEM_MASS * float(pads[:, 0].sum())  # m d.
    turning = float(inertia.CalcRotationalInertia().get_moments()[2]) + ITEM_MASS * float(np.square(pads).sum())
    effective_inertia = turning + spinning * NOMINAL.half_track**2
    leverage = float(np.mean(NOMINAL.wheel_radius / radii))
    pushing = leverage * NOMINAL.effective_mass / (mass + spinning)
    gyroscopic = gyroscopic_effect * YAW_COUPLING * NOMINAL.effective_yaw_inertia
    return TrueDynamics(
        yaw_coupling=(gyroscopic + ahead) / effective_inertia,
        propulsion_gain=pushing,
        brake_gain=pushing,
        yaw_gain=leverage * NOMINAL.effective_yaw_inertia / effective_inertia,
        lateral_slip=-PLANT_STEP,
    )


def _inertia_at_rest(hidden_truth: float) -> SpatialInertia:
    """Of the robot with its arm, about the middle of the axle's shadow on the floor, x ahead and z up.

    It leans on a caster: the larger its wheels, the more, and the farther ahead is its centre of mass.
    """
    builder = DiagramBuilder()
    plant, scene_graph = MakeCarePlant(builder)
    robot = AddCareRobot(plant, scene_graph, hidden_truth=hidden_truth, visible=False)
    AddFloor(plant)
    plant.Finalize()
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.get_actuation_input_port(robot.robot).FixValue(context, [0.0, 0.0])
    plant.get_desired_state_input_port(robot.arm).FixValue(context, [*STOWED, 0.0, 0.0, 0.0])
    simulator.AdvanceTo(_SETTLED)
    bodies = [*plant.GetBodyIndices(robot.robot), *plant.GetBodyIndices(robot.arm)]
    inertia = plant.CalcSpatialInertia(context, robot.base.body_frame(), bodies)
    return inertia.ReExpress(robot.base.EvalPoseInWorld(context).rotation())
