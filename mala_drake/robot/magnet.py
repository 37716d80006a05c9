"""The magnets: boxes clamped in their dispensers, and boxes hanging at the gripper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from mala_drake.buffered_function import BufferedFunction
from mala_drake.messages import MagnetCommand
from mala_drake.robot.arm_kinematics import PAD_OFFSETS
from mala_drake.robot.held_boxes import boxes_at_pads
from mala_drake.robot.item_messages import ClampedItems
from mala_drake.robot.items import ITEM_MASS, ItemBodies, X_WI_at
from mala_drake.robot.magnet_law import GRAVITY, MagnetLaw, Place
from mala_drake.robot.plant import ARM_JOINTS, CareRobot

CLAMP_REACH = 0.06
"""Distance from its place within which a dispenser gets hold of a box, m."""

_BODY_STATE = 13  # Numbers of a floating body's pose and velocity.

_AT_REST = 1e-9  # Deviations from a clamped pose, in m, rad, m/s or rad/s, that are not worth a computation.


@dataclass(frozen=True, slots=True)
class _Clamps:
    """A `ClampedItems` message as arrays."""

    places: tuple[Place, ...]
    forces: tuple[slice, ...]  # Where in the generalized forces theirs are.
    state_indices: NDArray[np.intp]  # (13 k,) into the plant's state: pose, then velocity of each box.
    carrying: NDArray[np.float64]  # The generalized forces that carry the weights and do nothing else.
    resting: NDArray[np.float64]  # (13 k,): where they belong, at rest.


@dataclass(frozen=True, slots=True)
class _Grip:
    """What a `MagnetCommand` holds, as arrays."""

    law: BufferedFunction  # See `boxes_at_pads`.
    arguments: NDArray[np.intp]  # Where in the plant's state its argument is.
    results: NDArray[np.intp]  # Where in the generalized forces its result is.


class Magnet(LeafSystem):
    """Holds boxes by force: those clamped in place, and those wanted at a pad of the gripper.

    .. pydrake_system::

        name: Magnet
        input_ports:
        - magnet
        - clamped
        - state
        output_ports:
        - generalized_force

    `magnet` is a `MagnetCommand`, `clamped` a `ClampedItems`, `state` the state of the whole plant. `generalized_force`
    has an entry for each velocity of the whole plant and goes to its `applied_generalized_force`, summed with others'.

    A clamped box is held at its pose. A box wanted at a pad hangs level below the roller, turned like the gripper (or
    half a turn from it), and its weight and inertia are felt by arm and base: the opposite wrench acts on the gripper.
    All other boxes are left to themselves. See `MagnetLaw` for what a magnet can hold; one that is out of reach is not
    pulled, so a box that was not brought near, or was torn away, is simply not there.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        robot: CareRobot,
        items: ItemBodies,
        *,
        pad: MagnetLaw | None = None,
        clamp: MagnetLaw | None = None,
    ) -> None:
        """Declares the magnets.

        Args:
            plant: finalized, with robot and items in it.
            robot: whose gripper has the pads.
            items: what can be held.
            pad: the magnets of the gripper; None for the default.
            clamp: the magnets of the dispensers; None for the default, which reaches farther.
        """
        super().__init__()
        self._pad = pad if pad is not None else MagnetLaw()
        self._clamp = clamp if clamp is not None else MagnetLaw(reach=CLAMP_REACH, either_way_round=False)
        self._items = {name: _floating(plant, body) for name, body in zip(items.names, items.bodies, strict=True)}
        # Compiled for each pad and for all of them: a function's memory, not state, like all that is kept here.
        pads = range(len(PAD_OFFSETS))
        self._laws = {each: boxes_at_pads(self._pad, each) for each in (*((pad,) for pad in pads), tuple(pads))}
        self._num_velocities = plant.num_velocities()
        self._base = _floating(plant, robot.base)
        joints = [plant.GetJointByName(name, robot.arm) for name in ARM_JOINTS]
        angles = [joint.position_start() for joint in joints]
        torques = [joint.velocity_start() for joint in joints]
        self._joint_states = (*angles, *(plant.num_positions() + start for start in torques))
        self._joint_torques = tuple(torques)
        self._clamps = (ClampedItems(), self._make_clamps(ClampedItems()))
        self._grip: tuple[tuple[tuple[str, int], ...], _Grip | None] = ((), None)
        self._magnet_port = self.DeclareAbstractInputPort("magnet", Value(MagnetCommand()))
        self._clamped_port = self.DeclareAbstractInputPort("clamped", Value(ClampedItems()))
        self._state_port = self.DeclareVectorInputPort("state", plant.num_multibody_states())
        ports = (self._magnet_port, self._clamped_port, self._state_port)
        self.DeclareVectorOutputPort(
            "generalized_force",
            self._num_velocities,
            self._calc_generalized_force,
            prerequisites_of_calc={port.ticket() for port in ports},
        )

    def _calc_generalized_force(self, context: Context, output: BasicVector) -> None:
        state = self._state_port.Eval(context)
        generalized = output.get_mutable_value()
        self._hold_clamped(state, self._clamps_of(self._clamped_port.Eval(context)), generalized)
        grip = self._grip_of(self._magnet_port.Eval(context))
        if grip is not None:
            grip.law.arguments[0][:, 0] = state.take(grip.arguments)
            grip.law()
            generalized[grip.results] += grip.law.results[0][:, 0]

    def _clamps_of(self, message: ClampedItems) -> _Clamps:
        """The message as arrays: kept from step to step, since it changes only when a box is taken or brought back."""
        if message is not self._clamps[0]:
            self._clamps = (message, self._make_clamps(message))
        return self._clamps[1]

    def _make_clamps(self, message: ClampedItems) -> _Clamps:
        boxes = [self._item(name) for name, _ in message.items]
        resting = np.zeros((len(boxes), _BODY_STATE))
        for row, (_, pose) in zip(resting, message.items, strict=True):
            # The sign of the quaternion is that of the plant's default pose, or a box at rest would never seem to be.
            row[:7] = *X_WI_at(pose).rotation().ToQuaternion().wxyz(), pose.x, pose.y, pose.z
        carrying = np.zeros(self._num_velocities)
        carrying[[box.force[-1] for box in boxes]] = ITEM_MASS * GRAVITY
        return _Clamps(
            places=tuple(Place((pose.x, pose.y, pose.z), pose.yaw) for _, pose in message.items),
            forces=tuple(slice(box.force.start, box.force.stop) for box in boxes),
            state_indices=np.array([index for box in boxes for index in box.state], dtype=np.intp),
            carrying=carrying,
            resting=resting.ravel(),
        )

    def _hold_clamped(self, state: NDArray[np.float64], clamps: _Clamps, generalized: NDArray[np.float64]) -> None:
        generalized[:] = clamps.carrying
        boxes = state.take(clamps.state_indices)
        deviations = boxes - clamps.resting
        if deviations.dot(deviations) < _AT_REST**2:
            return  # As nearly always: every box stands still in its place and only its weight has to be carried.
        astray = ~(np.abs(deviations).reshape(-1, _BODY_STATE).max(axis=1) < _AT_REST)  # Also where it is NaN.
        for row in np.flatnonzero(astray):
            torque, force = self._clamp.wrench(boxes.reshape(-1, _BODY_STATE)[row].tolist(), clamps.places[row])
            generalized[clamps.forces[row]] = (*torque, *force)

    def _grip_of(self, message: MagnetCommand) -> _Grip | None:
        """The message as arrays, kept from step to step likewise; None where nothing is held."""
        if message.held != self._grip[0]:
            self._grip = (message.held, self._make_grip(message))
        return self._grip[1]

    def _make_grip(self, message: MagnetCommand) -> _Grip | None:
        if not message.held:
            return None
        boxes, pads = [self._item(name) for name, _ in message.held], tuple(pad for _, pad in message.held)
        if pads not in self._laws:
            self._laws[pads] = boxes_at_pads(self._pad, pads)
        states = [index for box in boxes for index in box.state]
        forces = [index for box in boxes for index in box.force]
        return _Grip(
            self._laws[pads],
            arguments=np.array([*self._base.state, *states, *self._joint_states], dtype=np.intp),
            results=np.array([*self._base.force, *forces, *self._joint_torques], dtype=np.intp),
        )

    def _item(self, name: str) -> _Floating:
        """The box `name` in the plant's vectors.

        Raises:
            ValueError: there is no such box.
        """
        if name not in self._items:
            raise ValueError(f"the magnet is to hold {name!r}, but there is no such item")
        return self._items[name]


@dataclass(frozen=True, slots=True)
class _Floating:
    """Where a floating body is in the plant's vectors."""

    state: tuple[int, ...]  # Its pose and its velocity in the plant's state.
    force: range  # Its six among the generalized forces.


def _floating(plant: MultibodyPlant, body: RigidBody) -> _Floating:
    position, velocity = body.floating_positions_start(), body.floating_velocities_start_in_v()
    after = plant.num_positions() + velocity
    return _Floating((*range(position, position + 7), *range(after, after + 6)), range(velocity, velocity + 6))
