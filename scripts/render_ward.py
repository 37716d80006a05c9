"""Renders the README's pictures: the ward from above and the robot at work. Needs no display."""

from __future__ import annotations

import argparse
from math import radians
from pathlib import Path

from pydrake.systems.framework import DiagramBuilder

from mala_drake.reporting.scenery import AddPictureRenderer, RenderPicture, View, bird_eye_view, oblique_view, write_png
from mala_drake.robot.plant import AddCareRobot, MakeCarePlant, SetRobotPose
from mala_drake.robot.ward_plant import AddWard
from mala_drake.ward.ward_map import LoadWard, Place, Ward


def close_up(place: Place) -> View:
    """The surroundings of a place from half the height of a room."""
    return oblique_view(place.x + 1.0, place.y - 1.0, distance=9.0, azimuth=radians(-125.0), elevation=radians(33.0))


def render(ward: Ward, robot_at: Place, view: View, path: Path) -> None:
    builder = DiagramBuilder()
    plant, scene_graph = MakeCarePlant(builder)
    AddWard(plant, ward)
    robot = AddCareRobot(plant, scene_graph)
    plant.Finalize()
    AddPictureRenderer(scene_graph)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    SetRobotPose(plant, plant.GetMyContextFromRoot(context), robot, x=robot_at.x, y=robot_at.y, yaw=robot_at.yaw)
    write_png(RenderPicture(scene_graph, context, view), path)
    print(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(".readme"), help="folder of the pictures")
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    ward = LoadWard()
    bedside = ward.place["patient_bed_left"]
    render(ward, ward.place["home"], bird_eye_view(ward), folder / "ward.png")
    render(ward, bedside, close_up(bedside), folder / "bedside.png")


if __name__ == "__main__":
    main()
