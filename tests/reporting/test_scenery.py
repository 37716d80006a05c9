"""Views by projective geometry, and pictures by what is in them."""

from __future__ import annotations

import base64
import re
import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.image import imread
from pydrake.geometry import Meshcat
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from mala_drake.reporting import scenery as mut
from mala_drake.robot.ward_plant import AddWard
from mala_drake.ward.furnishing.palette import FUNCTION_COLORS
from mala_drake.ward.ward_map import LoadWard

WIDTH, HEIGHT = 480, 300


def pixel_of(view: mut.View, point: list[float]) -> np.ndarray:
    """Where a pinhole camera sees the point, in pixels."""
    x, y, z = mut.X_WC_of(view).inverse() @ np.array(point)
    assert z > 0, "behind the camera"
    focal = HEIGHT / 2 / np.tan(np.radians(45.0) / 2)
    return np.array([WIDTH / 2 + focal * x / z, HEIGHT / 2 + focal * y / z])


positions = st.tuples(*[st.floats(-50.0, 50.0)] * 3)


@given(positions, positions.filter(lambda p: p[2] > 1.0))
def test_cameras_look_at_their_target_with_the_horizon_level(target, offset):
    view = mut.View((target[0] + offset[0] + 1.0, target[1] + offset[1], target[2] + offset[2]), target)
    np.testing.assert_allclose(pixel_of(view, list(target)), [WIDTH / 2, HEIGHT / 2], atol=1e-6)
    rotation = mut.X_WC_of(view).rotation().matrix()
    assert rotation[2, 0] == pytest.approx(0.0, abs=1e-9)  # The picture's rows are level,
    assert rotation[2, 1] <= 0.0  # and up is up.


def test_every_place_is_in_the_bird_eye_view():
    ward = LoadWard()
    view = mut.bird_eye_view(ward)
    for place in ward.places:
        for height in (0.0, 2.0):
            column, row = pixel_of(view, [place.x, place.y, height])
            assert 0 < column < WIDTH, place.name
            assert 0 < row < HEIGHT, place.name


@pytest.fixture(scope="module")
def picture(tmp_path_factory) -> np.ndarray:
    ward = LoadWard()
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.01)
    AddWard(plant, ward)
    plant.Finalize()
    mut.AddPictureRenderer(scene_graph)
    context = builder.Build().CreateDefaultContext()
    view = mut.bird_eye_view(ward)
    rendered = mut.RenderPicture(scene_graph, context, view, width=WIDTH, height=HEIGHT)
    path = tmp_path_factory.mktemp("pictures") / "ward.png"
    mut.write_png(rendered, path)
    return (255 * imread(path)[:, :, :3]).round().astype(int)


def test_the_ward_is_rendered_in_bright_light(picture):
    assert picture.shape == (HEIGHT, WIDTH, 3)
    assert picture.mean() > 180


def test_the_colors_of_all_functions_are_seen_where_their_signs_are(picture):
    """Within a few pixels of where the pinhole camera sees a sign there is a pixel of its hue."""
    ward = LoadWard()
    view = mut.bird_eye_view(ward)
    for place in ward.places:
        piece = ward.furniture_of.get(place.name)
        if piece is None:
            continue
        column, row = pixel_of(view, [piece.x, piece.y, 2.8]).astype(int)
        around = picture[max(row - 8, 0) : row + 9, max(column - 8, 0) : column + 9].reshape(-1, 3)
        color = np.array(FUNCTION_COLORS[place.category])
        directions = (around - around.mean(axis=1, keepdims=True)) / 255
        likeness = directions @ (color - color.mean()) / np.linalg.norm(color - color.mean()) ** 2
        assert likeness.max() > 0.5, place.name


def test_scenery_in_meshcat_hides_the_grid_and_puts_the_camera():
    meshcat = Meshcat()
    mut.SetScenery(meshcat, mut.oblique_view(1.0, 2.0, distance=10.0))
    sent = [base64.b64decode(data) for data in re.findall(r'base64,([A-Za-z0-9+/=]+)"', meshcat.StaticHtml())]
    for hidden in (b"/Grid", b"/Axes"):
        (message,) = [message for message in sent if hidden in message and b"visible" in message]
        assert message.endswith(b"\xc2")  # False, in MessagePack.
    (target,) = [message for message in sent if b"set_target" in message]
    # The viewer's y axis is up: the point (1, 2, 0) of the ward is (1, 0, -2) there.
    assert target.endswith(b"\xcb".join((b"", *(struct.pack(">d", value) for value in (1.0, 0.0, -2.0)))))
