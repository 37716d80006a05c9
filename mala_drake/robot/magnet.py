"""The magnets: boxes clamped in their dispensers, and boxes hanging at the gripper."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from mala_drake.messages import MagnetCommand
from mala_drake.robot.arm_kinematics import PAD_RADIUS
from mala_drake.robot.gripper_motion import GripperMotion, gripper_motion
from mala_drake.robot.item_messages import ClampedItems
from mala_drake.robot.items import ITEM_MASS, ItemBodies
from mala_drake.robot.magnet_law import GRAVITY, MagnetLaw, Place
from mala_drake.robot.plant import ARM_JOINTS, CareRobot
from mala_drake.ward.items import ITEM_HALF_HEIGHT

CLAMP_REACH = 0.06
"""Distance from its place within which a dispenser gets hold of a box, m."""

_AT_REST = 1e-9  # Deviations from a clamped pose, in m, rad, m/s or rad/s, that are not worth a computation.


@dataclass(frozen=True, slots=True)
class _Clamps:
    """A `ClampedItems` message as arrays."""

    places: tuple[Place, ...]
    forces: tuple[slice, ...]  # Where in the generalized forces theirs are.
    state_indices: NDArray[np.intp]  # (k, 13) into the plant's state: pose, then velocity of each box.
    weights: NDArray[np.intp]  # (k,) into the generalized forces: what pulls each box up.
    resting: NDArray[np.float64]  # (k, 13): where they belong, at rest.


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
        self._num_velocities = plant.num_velocities()
        self._base = _floating(plant, robot.base)
        joints = [plant.GetJointByName(name, robot.arm) for name in ARM_JOINTS]
        self._joint_positions = [joint.position_start() for joint in joints]
        self._joint_velocities = [joint.velocity_start() for joint in joints]
        self._joint_rates = [plant.num_positions() + start for start in self._joint_velocities]
        self._clamps = (ClampedItems(), self._make_clamps(ClampedItems()))
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
        held = self._magnet_port.Eval(context).held
        generalized = np.zeros(self._num_velocities)
        self._hold_clamped(state, self._clamps_of(self._clamped_port.Eval(context)), generalized)
        if held:
            motion = self._gripper_motion(state)
            for item, pad in held:
                self._hold_at_pad(state, motion, item, pad, generalized)
        output.SetFromVector(generalized)

    def _clamps_of(self, message: ClampedItems) -> _Clamps:
        """The message as arrays: kept from step to step, since it changes only when a box is taken or brought back."""
        if message is not self._clamps[0]:
            self._clamps = (message, self._make_clamps(message))
        return self._clamps[1]

    def _make_clamps(self, message: ClampedItems) -> _Clamps:
        boxes = [self._item(name) for name, _ in message.items]
        state_indices = np.array([box.state_indices() for box in boxes], dtype=np.intp).reshape(-1, 13)
        resting = np.zeros(state_indices.shape)
        for row, (_, pose) in zip(resting, message.items, strict=True):
            row[:7] = math.cos(0.5 * pose.yaw), 0.0, 0.0, math.sin(0.5 * pose.yaw), pose.x, pose.y, pose.z
        places = tuple(Place((pose.x, pose.y, pose.z), pose.yaw) for _, pose in message.items)
        weights = np.array([box.force.stop - 1 for box in boxes], dtype=np.intp)
        return _Clamps(places, tuple(box.force for box in boxes), state_indices, weights, resting)

    def _hold_clamped(self, state: NDArray[np.float64], clamps: _Clamps, generalized: NDArray[np.float64]) -> None:
        boxes = state[clamps.state_indices]
        generalized[clamps.weights] = ITEM_MASS * GRAVITY
        deviations = np.abs(boxes - clamps.resting)
        if deviations.size == 0 or deviations.max() < _AT_REST:
            return  # As nearly always: every box stands still in its place and only its weight has to be carried.
        for row in np.flatnonzero(~(deviations.max(axis=1) < _AT_REST)):
            torque, force = self._clamp.wrench(boxes[row].tolist(), clamps.places[row])
            generalized[clamps.forces[row]] = (*torque, *force)

    def _gripper_motion(self, state: NDArray[np.float64]) -> GripperMotion:
        angles, rates = state[self._joint_positions].tolist(), state[self._joint_rates].tolist()
        return gripper_motion(self._base.state(state), angles, rates)

    def _hold_at_pad(
        self, state: NDArray[np.float64], motion: GripperMotion, item: str, pad: int, generalized: NDArray[np.float64]
    ) -> None:
        floating = self._item(item)
        box = floating.state(state)
        middle = motion.pad_position(pad)
        hanging = (middle[0], middle[1], middle[2] - PAD_RADIUS - ITEM_HALF_HEIGHT)
        place = Place(hanging, motion.yaw, motion.velocity_at(middle), motion.yaw_rate)
        torque, force = self._pad.wrench(box, place)
        generalized[floating.force] = (*torque, *force)
        reaction = ((-torque[0], -torque[1], -torque[2]), (-force[0], -force[1], -force[2]))
        base, joints = motion.generalized_force((box[4], box[5], box[6]), *reaction)
        generalized[self._base.force] += base
        generalized[self._joint_velocities] += joints

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

    pose: slice  # Seven numbers of the plant's state.
    velocity: slice  # Six numbers of the plant's state.
    force: slice  # Six numbers of the plant's velocities.

    def state(self, state: NDArray[np.float64]) -> list[float]:
        """Pose and velocity, 13 numbers."""
        return [*state[self.pose].tolist(), *state[self.velocity].tolist()]

    def state_indices(self) -> list[int]:
        """The 13 places of `state`."""
        return [*range(self.pose.start, self.pose.stop), *range(self.velocity.start, self.velocity.stop)]


def _floating(plant: MultibodyPlant, body: RigidBody) -> _Floating:
    position, velocity = body.floating_positions_start(), body.floating_velocities_start_in_v()
    after = plant.num_positions() + velocity
    return _Floating(slice(position, position + 7), slice(after, after + 6), slice(velocity, velocity + 6))
