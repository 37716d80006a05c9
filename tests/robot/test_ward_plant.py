"""The ward in a plant: what is solid is the map, nothing moves, and nothing seen sticks out."""

from __future__ import annotations

import tempfile
from dataclasses import replace

import numpy as np
import pytest
import shapely
from pydrake.geometry import Box, Capsule, Cylinder, Ellipsoid, Mesh, Role, SceneGraph, Shape, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import LoadModelDirectives, Parser, ProcessModelDirectives
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from mala_drake.errors import BadInput
from mala_drake.resources import models_folder
from mala_drake.robot import ward_plant as mut
from mala_drake.ward.models import LEDGE_DEPTH, LEDGE_HEIGHT
from mala_drake.ward.shapes import outline
from mala_drake.ward.ward_map import Furniture, LoadWard, Ward

LEDGE_CATEGORIES = ("pharmacy", "supply", "kitchen")


class Built:
    """A ward in a finalized plant, with what the tests ask about it."""

    def __init__(self, ward: Ward, *, visible: bool = True) -> None:
        self.ward = ward
        builder = DiagramBuilder()
        self.plant, self.scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.01)
        self.geometry = mut.AddWard(self.plant, ward, visible=visible)
        self.plant.Finalize()
        self.diagram = builder.Build()
        self.inspector = self.scene_graph.model_inspector()

    def solids(self, name: str) -> list[tuple[Shape, RigidTransform]]:
        ids = self.geometry.solids[name]
        return [(self.inspector.GetShape(id_), self.inspector.GetPoseInFrame(id_)) for id_ in ids]

    def distance(self, point: list[float]) -> float:
        """Signed distance from a point to the nearest solid, by Drake."""
        context = self.diagram.CreateDefaultContext()
        query = self.scene_graph.get_query_output_port().Eval(self.scene_graph.GetMyContextFromRoot(context))
        return min(found.distance for found in query.ComputeSignedDistanceToPoint(np.array(point)))


@pytest.fixture(scope="module")
def built() -> Built:
    return Built(LoadWard())


def plan_view(shape: Shape, X_WG: RigidTransform) -> shapely.Polygon:
    """The outline of a shape's points seen from above; exact for upright boxes and cylinders."""
    angles = np.linspace(0.0, 2 * np.pi, 721)
    circle = np.column_stack((np.cos(angles), np.sin(angles)))
    if isinstance(shape, Box):
        signs = np.array(np.meshgrid(*([(-0.5, 0.5)] * 3))).reshape(3, -1).T
        points = signs * shape.size()
    elif isinstance(shape, Cylinder):
        points = np.vstack([np.column_stack((shape.radius() * circle, np.full(721, z))) for z in (-1.0, 1.0)])
        points[:, 2] *= shape.length() / 2
    elif isinstance(shape, Ellipsoid):
        rings = [np.column_stack((np.cos(e) * circle, np.full(721, np.sin(e)))) for e in np.linspace(-1.57, 1.57, 41)]
        points = np.vstack(rings) * [shape.a(), shape.b(), shape.c()]
    elif isinstance(shape, Capsule):
        rings = [np.column_stack((np.cos(e) * circle, np.full(721, np.sin(e)))) for e in np.linspace(-1.57, 1.57, 41)]
        ball = shape.radius() * np.vstack(rings)
        ends = [ball + np.array([0.0, 0.0, z]) for z in (-shape.length() / 2, shape.length() / 2)]
        points = np.vstack(ends)
    else:
        raise AssertionError(f"a shape that furniture does not have: {shape}")
    return shapely.MultiPoint((X_WG @ points.T).T[:, :2]).convex_hull


def exact_footprint(piece: Furniture) -> shapely.Polygon:
    if piece.radius > 0:
        return shapely.Point(piece.x, piece.y).buffer(piece.radius, quad_segs=180)
    return outline(piece.shape)


def assert_solids_fill_the_map(built: Built) -> None:
    assert set(built.geometry.solids) == {piece.name for piece in (*built.ward.furniture, *built.ward.walls)}
    for piece in (*built.ward.furniture, *built.ward.walls):
        solid = shapely.union_all([plan_view(shape, X_WG) for shape, X_WG in built.solids(piece.name)])
        footprint = exact_footprint(piece)
        assert shapely.symmetric_difference(solid, footprint).area <= 1e-4 * footprint.area, piece.name


def test_solid_outlines_are_the_shapes_of_the_map(built):
    assert_solids_fill_the_map(built)


def test_what_is_seen_of_furniture_stays_inside_its_footprint(built):
    frame = built.scene_graph.world_frame_id()
    pieces = {piece.name: exact_footprint(piece).buffer(2e-3) for piece in (*built.ward.furniture, *built.ward.walls)}
    seen = dict.fromkeys(pieces, 0)
    for visual in built.inspector.GetGeometries(frame, Role.kIllustration):
        owner = built.inspector.GetName(visual).split("/")[0].rpartition("::")[2]
        if owner in pieces:
            seen[owner] += 1
            shown = plan_view(built.inspector.GetShape(visual), built.inspector.GetPoseInFrame(visual))
            assert pieces[owner].contains(shown), built.inspector.GetName(visual)
    assert min(seen.values()) > 0


def test_everything_is_anchored_and_adds_no_body(built):
    assert built.plant.num_bodies() == 1
    assert built.plant.num_multibody_states() == 0
    assert built.inspector.NumDynamicGeometries() == 0


def test_items_have_a_ledge_in_front_of_the_robot(built):
    served = [p for p in built.ward.furniture if p.serves and built.ward.place[p.serves].category in LEDGE_CATEGORIES]
    assert len(served) == 9
    for piece in served:
        place = built.ward.place[piece.serves]
        front = np.array([np.sin(piece.yaw), -np.cos(piece.yaw)])  # The piece's own -y axis.
        to_robot = np.array([place.x - piece.x, place.y - piece.y])
        assert front @ to_robot / np.linalg.norm(to_robot) > 0.9, f"{piece.name} turns its back to {place.name}"
        ledge = np.array([piece.x, piece.y]) + (piece.half_width - LEDGE_DEPTH / 2) * front
        assert built.distance([*ledge, LEDGE_HEIGHT + 0.05]) == pytest.approx(0.05, abs=1e-6)
        assert built.distance([*ledge, LEDGE_HEIGHT - 0.05]) == pytest.approx(-0.05, abs=1e-6)
        if piece.height > LEDGE_HEIGHT + 0.2:
            behind = np.array([piece.x, piece.y]) + (piece.half_width - LEDGE_DEPTH - 0.05) * front
            assert built.distance([*behind, LEDGE_HEIGHT + 0.1]) == pytest.approx(-0.05, abs=1e-6)


def test_bedside_tables_carry_things_at_their_height(built):
    for name in ("bedside_table_left", "bedside_table_right"):
        (piece,) = [piece for piece in built.ward.furniture if piece.name == name]
        assert built.distance([piece.x, piece.y, piece.height + 0.03]) == pytest.approx(0.03, abs=1e-6)


def test_a_ball_rests_on_the_floor_and_is_stopped_by_a_wall():
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.005)
    ward = LoadWard()
    mut.AddWard(plant, ward, visible=False)
    ball = plant.AddRigidBody("ball", SpatialInertia.SolidSphereWithMass(2.0, 0.2))
    plant.RegisterCollisionGeometry(ball, RigidTransform(), Sphere(0.2), "ball", CoulombFriction(0.5, 0.5))
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetFreeBodyPose(context, ball, RigidTransform([-20.0, 0.0, 0.2]))
    plant.SetVelocities(context, np.array([0.0, -15.0, 0.0, -3.0, 0.0, 0.0]))
    simulator.AdvanceTo(3.0)
    x, _, z = plant.EvalBodyPoseInWorld(context, ball).translation()
    assert z == pytest.approx(0.2, abs=5e-3)
    assert -ward.half_extent + ward.wall_half_thickness + 0.19 < x < -20.0


def test_a_ward_of_ones_own_is_generated_and_leaves_no_files(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    shipped = LoadWard()
    furniture = (
        Furniture("my_bed", "bed", 3.0, 4.0, 0.9, yaw=0.5, half_length=0.9, half_width=1.7, serves="home"),
        Furniture("my_plant", "planter", -3.0, 4.0, 1.5, radius=0.3),
        Furniture("my_fridge", "fridge", -3.0, -4.0, 1.3, half_length=0.5, half_width=0.6),
        Furniture("my_wall", "partition", 0.0, -2.0, 2.2, yaw=1.0, half_length=1.23, half_width=0.05),
    )
    own = replace(shipped, name="own", half_extent=8.0, furniture=furniture, places=shipped.places[:1], zones=())
    built = Built(own)
    assert_solids_fill_the_map(built)
    assert list(tmp_path.iterdir()) == []
    frame = built.scene_graph.world_frame_id()
    shapes = [built.inspector.GetShape(id_) for id_ in built.inspector.GetGeometries(frame, Role.kIllustration)]
    meshes = [shape for shape in shapes if isinstance(shape, Mesh)]
    assert len(meshes) == 4  # Two of the floor, the letters and the mark of home.
    assert all(not mesh.source().is_path() for mesh in meshes)


def test_an_invisible_ward_is_as_solid(built):
    hidden = Built(LoadWard(), visible=False)
    frame = hidden.scene_graph.world_frame_id()
    assert hidden.inspector.GetGeometries(frame, Role.kIllustration) == []
    assert_solids_fill_the_map(hidden)


def test_the_directives_file_alone_gives_the_same_solids(built):
    scene_graph, plant = SceneGraph(), MultibodyPlant(time_step=0.0)
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    parser = Parser(plant)
    parser.package_map().AddPackageXml(models_folder() / "package.xml")
    ProcessModelDirectives(LoadModelDirectives(models_folder() / "care_center.dmd.yaml"), parser)
    plant.Finalize()
    inspector = scene_graph.model_inspector()
    expected = len(inspector.GetAllGeometryIds(Role.kProximity))
    assert expected == sum(map(len, built.geometry.solids.values())) + 1
    assert plant.num_multibody_states() == 0


def test_an_unknown_model_is_refused_in_one_line():
    ward = LoadWard()
    odd = Furniture("thing", "sofa", 0.0, 0.0, 1.0, half_length=1.0, half_width=1.0)
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.01)
    with pytest.raises(BadInput, match="'sofa'"):
        mut.AddWard(plant, replace(ward, furniture=(odd,)))
