"""An obstacle in the plant: solid where its shape is, up to its height."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from mala_drake.messages import Shape
from mala_drake.robot import obstacle as mut


def test_it_is_solid_where_its_shape_is():
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.01)
    mut.AddObstacle(plant, Shape("trolley", 2.0, 1.0, np.pi / 6, half_length=0.5, half_width=0.25), height=0.8)
    plant.Finalize()
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(context))
    along, across = np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)]), np.array([-np.sin(np.pi / 6), np.cos(np.pi / 6)])

    def distance(offset, z):
        (found,) = query.ComputeSignedDistanceToPoint(np.array([*(np.array([2.0, 1.0]) + offset), z]))
        return found.distance

    for offset, z, expected in (
        (0.7 * along, 0.4, 0.2),
        (0.45 * across, 0.4, 0.2),
        (0.0 * along, 0.9, 0.1),
        (0.4 * along, 0.4, -0.1),
        (0.0 * along, 0.05, -0.05),
    ):
        assert distance(offset, z) == pytest.approx(expected, abs=1e-9)
