"""What stands about in the ward without being on any map."""

from __future__ import annotations

from pydrake.geometry import Box, GeometryId
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant

from mala_drake.messages import Shape

_COLOR = (0.85, 0.35, 0.20, 1.0)  # Of a trolley.


def AddObstacle(plant: MultibodyPlant, shape: Shape, *, height: float) -> GeometryId:
    """Fixes an upright box to the floor; returns what is solid.

    Args:
        plant: not finalized, registered with a SceneGraph.
        shape: seen from above; its corners are sharp, whatever its radius.
        height: metres.
    """
    box = Box(2 * shape.half_length, 2 * shape.half_width, height)
    X_WO = RigidTransform(RollPitchYaw(0.0, 0.0, shape.yaw), [shape.x, shape.y, 0.5 * height])
    name = f"obstacle/{shape.name}"
    plant.RegisterVisualGeometry(plant.world_body(), X_WO, box, name, list(_COLOR))
    return plant.RegisterCollisionGeometry(plant.world_body(), X_WO, box, name, CoulombFriction(0.5, 0.5))
