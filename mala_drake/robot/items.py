"""The boxes of medicines, supplements and ingredients as free bodies in the plant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody

from mala_drake.resources import models_folder
from mala_drake.robot.plant import CareRobot, MakeCareParser
from mala_drake.robot.visuals import without_visuals
from mala_drake.ward.items import Item, ItemPose

ITEM_MASS = 0.2
"""kg, of every box."""

ITEM_INERTIA = 2.2e-4
"""kg m^2: the mean of a box's three moments of inertia."""

KIND_COLORS = {
    "med_antibiotic": "0.84 0.18 0.22 1",
    "med_analgesic": "0.93 0.55 0.12 1",
    "med_insulin": "0.55 0.27 0.68 1",
    "supp_vitamin_d": "0.95 0.80 0.20 1",
    "supp_electrolyte": "0.20 0.60 0.86 1",
    "supp_omega3": "0.15 0.62 0.35 1",
    "bread": "0.80 0.56 0.28 1",
    "nuts": "0.48 0.28 0.14 1",
    "vegetables": "0.30 0.66 0.22 1",
    "chicken": "0.95 0.66 0.58 1",
}
"""Red, green, blue and opacity of each kind, as SDF writes them."""

_MODELS = {"med": "item_medicine.sdf", "supp": "item_supplement.sdf"}  # By what a kind begins with.
_UNKNOWN_COLOR = "0.60 0.60 0.60 1"


@dataclass(frozen=True, slots=True)
class ItemBodies:
    """Handles to the boxes in a plant, both tuples in the same order."""

    names: tuple[str, ...]
    bodies: tuple[RigidBody, ...]

    def body(self, name: str) -> RigidBody:
        """The body of the box `name`."""
        return self.bodies[self.names.index(name)]


def AddItems(
    plant: MultibodyPlant, scene_graph: SceneGraph, items: Sequence[Item], robot: CareRobot, *, visible: bool = True
) -> ItemBodies:
    """Adds a free body for each item, by default on its shelf; each is a model instance of the item's name.

    Medicines (`med_...`) are cartons, supplements (`supp_...`) jars, everything else is a tray of food. The arm and the
    boxes pass through each other: what holds a box is the magnet's force, not the shape of the gripper.

    Args:
        plant: not finalized, the robot already in it.
        scene_graph: the plant's.
        items: at least the boxes the station knows; their names must be different.
        robot: whose arm is not to collide with them.
        visible: whether they are also to be seen; a plant that nobody looks at steps faster without.
    """
    bodies = tuple(_add_item(plant, item, visible) for item in items)
    filter_manager = scene_graph.collision_filter_manager()
    arm = [plant.GetBodyByName(name, robot.arm) for name in ("upper_arm", "forearm")]
    filter_manager.Apply(
        CollisionFilterDeclaration().ExcludeBetween(_geometries(plant, arm), _geometries(plant, bodies))
    )
    return ItemBodies(tuple(item.name for item in items), bodies)


def X_WI_at(pose: ItemPose) -> RigidTransform:
    """The pose of a box in the world."""
    return RigidTransform(RollPitchYaw(0.0, 0.0, pose.yaw), [pose.x, pose.y, pose.z])


def _add_item(plant: MultibodyPlant, item: Item, visible: bool) -> RigidBody:
    model = _MODELS.get(item.kind.partition("_")[0], "item_ingredient.sdf")
    text = _named_and_coloured(models_folder() / model, item)
    (instance,) = MakeCareParser(plant).AddModelsFromString(text if visible else without_visuals(text), "sdf")
    body = plant.GetBodyByName("box", instance)
    plant.SetDefaultFloatingBaseBodyPose(body, X_WI_at(item.shelf_pose))
    return body


def _named_and_coloured(path: Path, item: Item) -> str:
    root = ElementTree.parse(path).getroot()
    for model in root.iter("model"):
        model.set("name", item.name)
    for visual in root.iter("visual"):
        if visual.get("name", "").startswith("coloured_"):
            for color in visual.findall("material/diffuse"):
                color.text = KIND_COLORS.get(item.kind, _UNKNOWN_COLOR)
    return ElementTree.tostring(root, encoding="unicode")


def _geometries(plant: MultibodyPlant, bodies: Sequence[RigidBody]) -> GeometrySet:
    return GeometrySet([g for body in bodies for g in plant.GetCollisionGeometriesForBody(body)])
