"""How the ward is looked at: views, light and background, in Meshcat and in rendered pictures."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, degrees, hypot, radians, sin
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    ClippingRange,
    ColorRenderCamera,
    LightParameter,
    MakeRenderEngineVtk,
    Meshcat,
    RenderCameraCore,
    RenderEngineVtkParams,
    SceneGraph,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.framework import Context
from pydrake.systems.sensors import CameraInfo

from mala_drake.ward.ward_map import Ward

_SKY_TOP = (0.80, 0.89, 0.96)
_SKY_BOTTOM = (0.96, 0.97, 0.98)
_FIELD_OF_VIEW = radians(45.0)  # Vertical.
_NEAREST, _FARTHEST = 0.3, 400.0  # Clipping planes, metres: nearer than 0.3 m, far signs begin to flicker.
_RENDERER = "picture"


@dataclass(frozen=True, slots=True)
class View:
    """Where the camera is and what it looks at; metres, world frame."""

    camera: tuple[float, float, float]
    target: tuple[float, float, float]


def oblique_view(
    x: float, y: float, *, distance: float, azimuth: float = radians(-102.0), elevation: float = radians(48.0)
) -> View:
    """A view of the floor at (x, y) from `distance` metres, from direction `azimuth` and `elevation` in radians."""
    along = distance * cos(elevation)
    return View((x + along * cos(azimuth), y + along * sin(azimuth), distance * sin(elevation)), (x, y, 0.0))


def bird_eye_view(ward: Ward) -> View:
    """An oblique view from the south that has every place of the ward in it."""
    xs, ys = [place.x for place in ward.places], [place.y for place in ward.places]
    center_x, center_y = (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2
    reach = max(hypot(x - center_x, y - center_y) for x, y in zip(xs, ys, strict=True))
    # Perspective makes the near half look larger: aim a little to the south of the middle.
    return oblique_view(center_x, center_y - 0.1 * reach, distance=1.95 * reach)


def SetScenery(meshcat: Meshcat, view: View) -> None:
    """Lights the ward in Meshcat like a bright room, hides grid and axes, and puts the camera to `view`."""
    for shown in ("/Grid", "/Axes"):
        meshcat.SetProperty(shown, "visible", False)
    meshcat.SetProperty("/Background/<object>", "top_color", list(_SKY_TOP))
    meshcat.SetProperty("/Background/<object>", "bottom_color", list(_SKY_BOTTOM))
    for lamp in ("PointLightNegativeX", "PointLightPositiveX", "SpotLight"):
        meshcat.SetProperty(f"/Lights/{lamp}", "visible", False)
    meshcat.SetProperty("/Lights/AmbientLight/<object>", "intensity", 1.1)
    meshcat.SetProperty("/Lights/FillLight/<object>", "intensity", 2.25)
    meshcat.SetProperty("/Lights/FillLight/<object>", "position", [-12.0, -20.0, 30.0])
    meshcat.SetCamera(Meshcat.PerspectiveCamera(fov=degrees(_FIELD_OF_VIEW), near=_NEAREST, far=_FARTHEST))
    meshcat.SetCameraPose(np.array(view.camera, dtype=np.float64), np.array(view.target, dtype=np.float64))


def AddPictureRenderer(scene_graph: SceneGraph) -> None:
    """Gives the scene graph the renderer that `RenderPicture` uses; needs no display."""
    lights = [
        LightParameter(type="directional", direction=direction, frame="world", intensity=intensity)
        for direction, intensity in (
            # The floor, which faces up, gets about 1 in all; the low ones are for upright faces.
            ((0.35, 0.60, -0.75), 0.55),
            ((0.15, 0.95, -0.25), 0.60),
            ((0.95, 0.10, -0.25), 0.35),
            ((-0.70, -0.40, -0.60), 0.35),
            ((0.0, 0.0, -1.0), 0.12),
        )
    ]
    params = RenderEngineVtkParams(default_clear_color=_SKY_TOP, lights=lights)
    scene_graph.AddRenderer(_RENDERER, MakeRenderEngineVtk(params))


def X_WC_of(view: View) -> RigidTransform:
    """The pose of a camera frame (z forward, y down) that sees `view` with the horizon level."""
    camera, target = np.array(view.camera), np.array(view.target)
    forward = (target - camera) / np.linalg.norm(target - camera)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return RigidTransform(RotationMatrix(np.column_stack((right, np.cross(forward, right), forward))), camera)


def RenderPicture(
    scene_graph: SceneGraph, root_context: Context, view: View, *, width: int = 1280, height: int = 800
) -> NDArray[np.uint8]:
    """A picture of the scene, shape (height, width, 3).

    Args:
        scene_graph: has been given to `AddPictureRenderer`.
        root_context: of the diagram that holds it.
        view: where the camera is.
        width: pixels.
        height: pixels.
    """
    core = RenderCameraCore(
        _RENDERER,
        CameraInfo(width, height, _FIELD_OF_VIEW),
        ClippingRange(_NEAREST, _FARTHEST),
        RigidTransform(),
    )
    query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(root_context))
    image = query.RenderColorImage(ColorRenderCamera(core), scene_graph.world_frame_id(), X_WC_of(view))
    return np.array(image.data[:, :, :3])


def write_png(picture: NDArray[np.uint8], path: str | Path) -> None:
    """Writes a picture as PNG."""
    # Imported here because nothing else on this path needs matplotlib.
    from matplotlib.image import imsave

    imsave(path, picture)
