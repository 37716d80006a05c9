"""A plant that nobody looks at: the same physics, and nothing to be seen."""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Role
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from mala_drake.robot.items import AddItems
from mala_drake.robot.plant import AddCareRobot, AddFloor, MakeCarePlant
from mala_drake.ward.items import Item, ItemPose

FALLING = Item("supply_A/supp_omega3", "supp_omega3", "supply_A", ItemPose(0.25, 0.1, 0.9, 1.0))


def scene(*, visible):
    """A robot that accelerates in a curve, a box falling on it, and what is shown of them."""
    builder = DiagramBuilder()
    plant, scene_graph = MakeCarePlant(builder)
    robot = AddCareRobot(plant, scene_graph, hidden_truth=1.0, visible=visible)
    AddItems(plant, scene_graph, [FALLING], robot, visible=visible)
    AddFloor(plant)
    plant.Finalize()
    simulator = Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.get_actuation_input_port(robot.robot).FixValue(context, [3.0, 2.0])
    plant.get_desired_state_input_port(robot.arm).FixValue(context, np.zeros(6))
    states = []
    for tick in range(1, 6):
        simulator.AdvanceTo(0.2 * tick)
        states.append(plant.GetPositionsAndVelocities(context).copy())
    return np.array(states), scene_graph.model_inspector()


def test_nothing_is_seen_and_all_is_solid_as_before_and_moves_alike_to_the_last_bit():
    (seen, shown), (unseen, hidden) = scene(visible=True), scene(visible=False)
    assert seen.tobytes() == unseen.tobytes()
    assert not np.array_equal(seen[0], seen[-1])
    roles = Role.kIllustration, Role.kPerception, Role.kProximity
    assert [hidden.NumGeometriesWithRole(role) > 0 for role in roles] == [False, False, True]
    assert shown.NumGeometriesWithRole(Role.kIllustration) > 0
    assert shown.NumGeometriesWithRole(Role.kProximity) == hidden.NumGeometriesWithRole(Role.kProximity)
    assert len(shown.GetCollisionCandidates()) == len(hidden.GetCollisionCandidates())
