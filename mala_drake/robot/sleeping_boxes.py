"""Clamped boxes that nothing can touch sleep: no contacts are sought for them. They wake before anything is near."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    CollisionFilterDeclaration,
    GeometryId,
    GeometrySet,
    ProximityProperties,
    Role,
    SceneGraph,
)
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import Context

from mala_drake.clock import TICK
from mala_drake.robot.arm_kinematics import LINK_LENGTH
from mala_drake.robot.item_messages import ClampedItems

FASTEST = 4.0
"""m/s; nothing in the ward, driven, carried or thrown, is faster."""

WAKING_DISTANCE = 2.0 * LINK_LENGTH + 0.3 + FASTEST * TICK
"""Metres from the robot, seen from above, within which boxes are awake: all that its hull, its arm and a box that hangs
from it can come to within a tick."""

DISTURBING_DISTANCE = 0.2 + FASTEST * TICK
"""Metres from a loose box within which boxes are awake: all that it can come to within a tick."""

STILL = 1e-3
"""m/s and rad/s; a box that moves faster is loose."""

_QUATERNION = 4  # Positions of a floating body before its translation.


class SleepingBoxes:
    """Puts boxes to sleep and wakes them, in one context of a simulation; to be told between ticks.

    A box in its place stands a millimetre above the ledge, held by a magnet, so that nothing happens to it while
    nothing is near. Asleep, its geometries take no part in collisions, which makes a step of the plant cheaper. Boxes
    that are loose, which are those not clamped and those that move, stay awake and wake the boxes around them.

    The simulation runs as well without, all boxes awake: only a context changes, nothing of the diagram. What happens
    is the same to the last bit.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        scene_graph: SceneGraph,
        robot: RigidBody,
        boxes: Sequence[RigidBody],
        clamped: Callable[[], ClampedItems],
        context: Context,
    ) -> None:
        """Looks at a simulation in which all boxes are awake.

        Args:
            plant: finalized.
            scene_graph: the plant's.
            robot: its base.
            boxes: each of them named by its model instance.
            clamped: tells which boxes are clamped now.
            context: of the whole diagram.
        """
        self._plant, self._scene_graph = plant, scene_graph
        self._plant_context = plant.GetMyContextFromRoot(context)
        self._scene_graph_context = scene_graph.GetMyMutableContextFromRoot(context)
        self._names = [plant.GetModelInstanceName(box.model_instance()) for box in boxes]
        self._geometries = [self._geometries_of(box) for box in boxes]
        self._filtered = [self._filtered_with(box, boxes) for box in boxes]
        (self._robot,), self._places = _planar_positions([robot]), _planar_positions(boxes)
        starts = [plant.num_positions() + box.floating_velocities_start_in_v() for box in boxes]
        self._velocities = np.array(starts, dtype=np.intp).reshape(-1, 1) + np.arange(6)
        self._asleep = np.zeros(len(boxes), dtype=bool)
        self._clamped = clamped
        self._newest = ClampedItems()
        self._loose = np.ones(len(boxes), dtype=bool)

    @property
    def asleep(self) -> tuple[str, ...]:
        """The names of the boxes that sleep."""
        return tuple(name for name, asleep in zip(self._names, self._asleep, strict=True) if asleep)

    def update(self) -> None:
        """Wakes and puts to sleep whatever is due; to be called at every tick, between two steps of the simulator."""
        clamped = self._clamped()
        if clamped is not self._newest:
            kept = {name for name, _ in clamped.items}
            self._newest, self._loose = clamped, np.array([name not in kept for name in self._names], dtype=bool)
        state = self._plant.GetPositionsAndVelocities(self._plant_context)
        still = np.abs(state[self._velocities]).max(axis=1, initial=0.0) < STILL  # Not where it is NaN.
        loose = self._loose | ~still
        places = state[self._places]
        disturbed = ~_far(places, state[self._robot][None, :], WAKING_DISTANCE)
        if loose.any():
            disturbed |= ~_far(places, places[loose], DISTURBING_DISTANCE)
        if (disturbed ^ self._asleep).all():
            return
        for index in np.flatnonzero(disturbed & self._asleep):
            self._wake(int(index))
        for index in np.flatnonzero(~disturbed & ~self._asleep):
            for geometry, _ in self._geometries[index]:
                source = self._plant.get_source_id()
                self._scene_graph.RemoveRole(self._scene_graph_context, source, geometry, Role.kProximity)
        self._asleep = ~disturbed

    def _wake(self, index: int) -> None:
        source, own = self._plant.get_source_id(), []
        for geometry, properties in self._geometries[index]:
            self._scene_graph.AssignRole(self._scene_graph_context, source, geometry, properties)
            own.append(geometry)
        # A geometry that gets its role back collides with everything but its own body.
        declaration = CollisionFilterDeclaration().ExcludeBetween(GeometrySet(own), self._filtered[index])
        self._scene_graph.collision_filter_manager(self._scene_graph_context).Apply(declaration)

    def _geometries_of(self, box: RigidBody) -> list[tuple[GeometryId, ProximityProperties]]:
        inspector = self._scene_graph.model_inspector()
        return [
            (geometry, ProximityProperties(inspector.GetProximityProperties(geometry)))
            for geometry in self._plant.GetCollisionGeometriesForBody(box)
        ]

    def _filtered_with(self, box: RigidBody, boxes: Sequence[RigidBody]) -> GeometrySet:
        """What a box does not collide with, other than boxes: those collide."""
        inspector = self._scene_graph.model_inspector()
        first, *_ = self._plant.GetCollisionGeometriesForBody(box)
        of_boxes = {geometry for each in boxes for geometry in self._plant.GetCollisionGeometriesForBody(each)}
        return GeometrySet(
            [
                geometry
                for geometry in inspector.GetAllGeometryIds(Role.kProximity)
                if geometry not in of_boxes and inspector.CollisionFiltered(first, geometry)
            ]
        )


def _planar_positions(bodies: Sequence[RigidBody]) -> NDArray[np.intp]:
    """Where x and y of floating bodies are in the plant's state, (n, 2)."""
    starts = [body.floating_positions_start() + _QUATERNION for body in bodies]
    return np.array(starts, dtype=np.intp).reshape(-1, 1) + np.arange(2)


def _far(places: NDArray[np.float64], others: NDArray[np.float64], distance: float) -> NDArray[np.bool_]:
    """Which of the places (n, 2) are farther than `distance` from all of the others (m, 2); none where it is NaN."""
    offsets = places[:, None, :] - others
    far: NDArray[np.bool_] = ((offsets * offsets).sum(axis=2) > distance * distance).all(axis=1)
    return far
