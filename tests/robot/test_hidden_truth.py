"""The hidden truth, read back from the plant."""

from __future__ import annotations

import math

import pytest
from pydrake.geometry import Sphere
from pydrake.systems.framework import DiagramBuilder

from mala_drake.errors import BadInput
from mala_drake.resources import models_folder
from mala_drake.robot import hidden_truth as mut
from mala_drake.robot.plant import AddCareRobot, MakeCarePlant


def _truth(scale):
    """Mass of the base and radii of the wheels in a plant."""
    builder = DiagramBuilder()
    plant, scene_graph = MakeCarePlant(builder)
    robot = AddCareRobot(plant, scene_graph, hidden_truth=scale)
    plant.Finalize()
    radii = []
    for name in ("left_wheel", "right_wheel"):
        (tyre,) = plant.GetCollisionGeometriesForBody(plant.GetBodyByName(name, robot.robot))
        shape = scene_graph.model_inspector().GetShape(tyre)
        assert isinstance(shape, Sphere)
        radii.append(shape.radius())
    return plant.GetBodyByName("base", robot.robot).default_mass(), *radii


def test_scale_zero_is_the_file_itself():
    text = (models_folder() / "care_robot.sdf").read_text()
    assert mut.with_hidden_truth(text, 0.0) == text


@pytest.mark.parametrize("scale", [0.5, 1.0, -1.0])
def test_mass_and_radii_are_off_by_a_few_per_cent(scale):
    mass, left, right = _truth(0.0)
    assert _truth(scale) == pytest.approx(
        (mass * (1 + 0.05 * scale), left * (1 + 0.02 * scale), right * (1 - 0.01 * scale))
    )


@pytest.mark.parametrize("scale", [math.nan, math.inf, -11.0])
def test_refuses_a_scale_that_makes_no_robot(scale):
    with pytest.raises(BadInput, match="hidden_truth"):
        mut.with_hidden_truth("<sdf/>", scale)


def test_the_rest_of_the_model_stays():
    """Drake must still know its own elements: without the collision filter the hull would touch its own wheels."""
    builder = DiagramBuilder()
    plant, scene_graph = MakeCarePlant(builder)
    AddCareRobot(plant, scene_graph, hidden_truth=1.0)
    plant.Finalize()
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(context))
    assert not query.HasCollisions()
