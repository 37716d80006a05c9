"""The ward's furniture and floor in a plant."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from pydrake.common import MemoryFile
from pydrake.geometry import (
    GeometryId,
    GeometryInstance,
    InMemoryMesh,
    Mesh,
    Role,
    SceneGraph,
    SceneGraphInspector,
    Shape,
)
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import LoadModelDirectivesFromString, Parser, ProcessModelDirectives
from pydrake.multibody.plant import MultibodyPlant

from mala_drake.resources import models_folder
from mala_drake.ward.models import FLOOR, PACKAGE_FOLDER, ward_directives, ward_files, ward_models
from mala_drake.ward.ward_map import LoadWard, Ward


@dataclass(frozen=True, slots=True)
class WardGeometry:
    """The solid geometries of a ward in a plant."""

    floor: GeometryId
    solids: Mapping[str, tuple[GeometryId, ...]]  # By the name of the furniture or wall.


def AddWard(plant: MultibodyPlant, ward: Ward | None = None, *, visible: bool = True) -> WardGeometry:
    """Adds floor, walls, furniture and signs of a ward to a plant, fixed to its world body.

    The ward's model directives are processed in a plant of their own, whose geometries are then registered with the
    world body of `plant`: seventy welded bodies would nearly double the time of a step and give the plant hundreds of
    ports, anchored geometries do neither.
    Models that are not among the package's files (another map, other sizes) are generated.

    Args:
        plant: not finalized, registered with a SceneGraph.
        ward: None is the hospital ward that comes with the package.
        visible: whether the ward is also to be seen; a plant that nobody looks at is built in half the time without.

    Raises:
        BadInput: when the map names a model that does not exist or cannot have the size.
    """
    ward = LoadWard() if ward is None else ward
    names = [model.name for model in ward_models(ward)]
    scene_graph = SceneGraph()
    furnished = MultibodyPlant(time_step=0.0)
    furnished.RegisterAsSourceForSceneGraph(scene_graph)
    with _folder_with_models(ward) as folder:
        parser = Parser(furnished)
        parser.package_map().Add("mala_drake", folder)
        ProcessModelDirectives(LoadModelDirectivesFromString(ward_directives(ward)), parser)
        furnished.Finalize()
        return _copy(names, furnished, scene_graph.model_inspector(), plant, visible)


@contextmanager
def _folder_with_models(ward: Ward) -> Iterator[Path]:
    """The package's folder if it has all files, else a temporary one with the missing files generated."""
    shipped = models_folder() / PACKAGE_FOLDER
    files = ward_files(ward)
    if all((shipped / name).is_file() for name in files):
        yield models_folder()
        return
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / PACKAGE_FOLDER
        folder.mkdir()
        for name, write in files.items():
            if (shipped / name).is_file():
                shutil.copy(shipped / name, folder / name)
            else:
                (folder / name).write_text(write(), encoding="utf-8")
        yield Path(temporary)


def _copy(
    names: Iterable[str],
    furnished: MultibodyPlant,
    inspector: SceneGraphInspector,
    plant: MultibodyPlant,
    visible: bool,
) -> WardGeometry:
    context = furnished.CreateDefaultContext()
    solids: dict[str, tuple[GeometryId, ...]] = {}
    for name in names:
        body = furnished.GetBodyByName("base", furnished.GetModelInstanceByName(name))
        frame = furnished.GetBodyFrameIdOrThrow(body.index())
        X_WB = furnished.EvalBodyPoseInWorld(context, body)
        for visual in inspector.GetGeometries(frame, Role.kIllustration) if visible else ():
            plant.RegisterVisualGeometry(plant.world_body(), _visual(inspector, visual, name, X_WB))
        solids[name] = tuple(
            plant.RegisterCollisionGeometry(
                plant.world_body(),
                X_WB @ inspector.GetPoseInFrame(solid),
                inspector.GetShape(solid),
                f"{name}/{_short_name(inspector, solid)}",
                inspector.GetProximityProperties(solid),
            )
            for solid in inspector.GetGeometries(frame, Role.kProximity)
        )
    (floor,) = solids.pop(FLOOR)
    return WardGeometry(floor, {name: ids for name, ids in solids.items() if ids})


def _short_name(inspector: SceneGraphInspector, geometry: GeometryId) -> str:
    return inspector.GetName(geometry).rpartition("::")[2]


def _visual(inspector: SceneGraphInspector, geometry: GeometryId, owner: str, X_WB: RigidTransform) -> GeometryInstance:
    """A copy of a visual geometry, placed in the world and independent of files."""
    original = inspector.CloneGeometryInstance(geometry)
    X_WG = X_WB @ original.pose()
    copy = GeometryInstance(X_WG, _without_file(original.shape()), f"{owner}/{_short_name(inspector, geometry)}")
    copy.set_illustration_properties(original.illustration_properties())
    perception = original.perception_properties()
    if perception is not None:
        # The label is a body of the other plant; this plant gives its own.
        perception.RemoveProperty("label", "id")
        copy.set_perception_properties(perception)
    return copy


def _without_file(shape: Shape) -> Shape:
    """Meshes in memory, since generated files are gone when the visualizer asks for them."""
    if not isinstance(shape, Mesh) or not shape.source().is_path() or shape.extension() != ".obj":
        return shape
    path = Path(shape.source().path())
    file = MemoryFile(path.read_text(encoding="utf-8"), ".obj", path.name)
    return Mesh(InMemoryMesh(mesh_file=file), shape.scale3())
