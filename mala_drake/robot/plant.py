"""The physics of the care robot: the discrete plant, the robot's model in it, and handles to its parts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Box, GeometryId, SceneGraph
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction, MultibodyPlant, MultibodyPlantConfig
from pydrake.multibody.tree import Frame, ModelInstanceIndex, PdControllerGains, RigidBody
from pydrake.systems.framework import Context, DiagramBuilder

from mala_drake.clock import PLANT_STEP
from mala_drake.resources import models_folder
from mala_drake.robot.arm_kinematics import STOWED
from mala_drake.robot.hidden_truth import with_hidden_truth
from mala_drake.robot.visuals import without_visuals

ARM_JOINTS = ("shoulder_yaw", "shoulder_pitch", "elbow_pitch")
"""The arm's joints, in the order of its positions."""

ARM_GAINS = {"shoulder_yaw": (2e4, 600.0), "shoulder_pitch": (2e4, 600.0), "elbow_pitch": (1e4, 200.0)}
"""Stiffness, N m/rad, and damping, N m s/rad, of each joint's controller; implicit in the discrete plant."""

FLOOR_FRICTION = 1.0

FLOOR_THICKNESS = 1.0


@dataclass(frozen=True, slots=True)
class CareRobot:
    """Handles to the care robot in a plant."""

    robot: ModelInstanceIndex  # Base and wheels: its state is laid out as in `mala_drake.robot.plant_state`.
    arm: ModelInstanceIndex
    base: RigidBody
    gripper: Frame  # In the middle of the magnet bar, its y along the bar.
    hull: GeometryId  # The collision geometry that bumps into things.


def MakeCarePlant(builder: DiagramBuilder) -> tuple[MultibodyPlant, SceneGraph]:
    """Adds the discrete plant of the project and its scene graph: point contact, the `lagged` approximation."""
    config = MultibodyPlantConfig(
        time_step=PLANT_STEP,
        discrete_contact_approximation="lagged",
        contact_model="point",
        # Keeping a sample of every output at each step would cost a fifth of the time; the few that are asked for are
        # computed from the state at hand, contact results by the very solution that the step then uses.
        use_sampled_output_ports=False,
    )
    return AddMultibodyPlant(config, builder)


def MakeCareParser(plant: MultibodyPlant) -> Parser:
    """A parser that finds the project's models under `package://mala_drake/`."""
    parser = Parser(plant)
    parser.package_map().Add("mala_drake", str(models_folder()))
    return parser


def AddFloor(plant: MultibodyPlant, *, size: float = 60.0) -> None:
    """Gives the world a solid, invisible floor at height 0; what it looks like is the ward's affair.

    It is a slab `size` metres square and not a half space, which the broad phase would hold against every geometry.
    """
    slab, friction = Box(size, size, FLOOR_THICKNESS), CoulombFriction(FLOOR_FRICTION, FLOOR_FRICTION)
    X_WF = RigidTransform([0.0, 0.0, -0.5 * FLOOR_THICKNESS])
    plant.RegisterCollisionGeometry(plant.world_body(), X_WF, slab, "floor", friction)


def AddCareRobot(
    plant: MultibodyPlant, scene_graph: SceneGraph, *, hidden_truth: float = 0.0, visible: bool = True
) -> CareRobot:
    """Adds the care robot with its arm stowed, standing at the origin and looking along x.

    Args:
        plant: not finalized yet, discrete (the arm's joint controllers need it).
        scene_graph: the plant's.
        hidden_truth: scale of the errors of mass and wheel radii, 0 for the nominal model.
        visible: whether it is also to be seen; a plant that nobody looks at steps faster without.
    """
    text = with_hidden_truth((models_folder() / "care_robot.sdf").read_text(), hidden_truth)
    (robot, arm) = MakeCareParser(plant).AddModelsFromString(text if visible else without_visuals(text), "sdf")
    for name, angle in zip(ARM_JOINTS, STOWED, strict=True):
        plant.GetJointByName(name, arm).set_default_angle(angle)
        stiffness, damping = ARM_GAINS[name]
        plant.GetJointActuatorByName(name, arm).set_controller_gains(PdControllerGains(p=stiffness, d=damping))
    base = plant.GetBodyByName("base", robot)
    inspector = scene_graph.model_inspector()
    (hull,) = [
        geometry
        for geometry in plant.GetCollisionGeometriesForBody(base)
        if inspector.GetName(geometry).endswith("hull")
    ]
    return CareRobot(robot, arm, base, plant.GetFrameByName("gripper", arm), hull)


def X_WB_at(x: float, y: float, yaw: float) -> RigidTransform:
    """The pose of the base of a robot standing on the floor at (x, y), metres, with heading `yaw`, radians."""
    return RigidTransform(RollPitchYaw(0.0, 0.0, yaw), [x, y, 0.0])


def SetRobotPose(
    plant: MultibodyPlant, plant_context: Context, robot: CareRobot, *, x: float, y: float, yaw: float
) -> None:
    """Puts the robot, at rest, to a place on the floor: metres, and radians for its heading."""
    pose = [math.cos(0.5 * yaw), 0.0, 0.0, math.sin(0.5 * yaw), x, y, 0.0]
    plant.SetPositions(plant_context, robot.robot, [*pose, 0.0, 0.0])
    plant.SetVelocities(plant_context, robot.robot, np.zeros(plant.num_velocities(robot.robot)))
    plant.SetVelocities(plant_context, robot.arm, np.zeros(plant.num_velocities(robot.arm)))
