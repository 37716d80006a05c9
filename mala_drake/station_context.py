"""Contexts of the care station: how one is set up for an episode, and what is carried from one to the next."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, Diagram

from mala_drake.errors import BadInput
from mala_drake.learning.abstract_learner import FloatArray
from mala_drake.robot.sleeping_boxes import SleepingBoxes


def StartEpisode(
    station: Diagram,
    context: Context,
    *,
    episode: int,
    time: float = 0.0,
    learner_states: Mapping[str, FloatArray] | None = None,
) -> None:
    """Sets a fresh default context up for an episode of the station's run.

    Args:
        station: from `MakeCareStation`.
        context: from `station.CreateDefaultContext()`.
        episode: its number, from 0.
        time: seconds on the simulation's clock at which it begins, a whole number of ticks.
        learner_states: what the learners have learned before, from `learner_states_of`; None at the beginning.

    Raises:
        BadInput: if `learner_states` are those of other learners than the station has.
    """
    context.SetTime(time)

    def own(name: str) -> tuple[Any, Context]:
        system = station.GetSubsystemByName(name)
        return system, system.GetMyMutableContextFromRoot(context)

    scheduler, its_context = own("scheduler")
    scheduler.start_at(its_context, episode=episode)
    estimator, its_context = own("state_estimator")
    estimator.SetEpisode(its_context, episode)
    fresh = learner_states_of(station, context)
    states = fresh if learner_states is None else learner_states
    if {name: state.shape for name, state in states.items()} != {name: state.shape for name, state in fresh.items()}:
        told, expected = (
            ", ".join(f"{name} ({state.size})" for name, state in each.items()) for each in (states, fresh)
        )
        raise BadInput("learner_states", told, f"numbers of {expected}")
    for name, state in states.items():
        learner, its_context = own(name)
        learner.set_learner_state(its_context, state, episode=episode)


def learner_states_of(station: Diagram, context: Context) -> dict[str, FloatArray]:
    """What each learner has learned so far in `context`: numbers by the system's name, to carry to the next episode."""
    learners: list[Any] = [system for system in station.GetSystems() if hasattr(system, "learner_state")]
    return {each.get_name(): each.learner_state(each.GetMyContextFromRoot(context)) for each in learners}


def SleepingBoxesOf(station: Diagram, context: Context) -> SleepingBoxes:
    """The station's boxes in `context`, awake as they are in a fresh one.

    Who updates them at every tick simulates faster; what happens is the same to the last bit.
    """
    plant: MultibodyPlant = station.GetSubsystemByName("plant")
    scene_graph: SceneGraph = station.GetSubsystemByName("scene_graph")
    world = station.GetSubsystemByName("world")
    its_context, clamped = world.GetMyContextFromRoot(context), world.GetOutputPort("clamped")
    bodies = [plant.get_body(index) for index in sorted(plant.GetFloatingBaseBodies(), key=int)]
    robot, *boxes = bodies  # The robot is added before the boxes.
    return SleepingBoxes(plant, scene_graph, robot, boxes, lambda: clamped.Eval(its_context), context)
