"""What holding boxes does to boxes and robot, compiled: the magnet needs it at every step of the plant."""

from __future__ import annotations

from collections.abc import Sequence

import casadi

from mala_drake.buffered_function import BufferedFunction, densified
from mala_drake.robot.arm_kinematics import PAD_RADIUS
from mala_drake.robot.gripper_motion import gripper_motion
from mala_drake.robot.magnet_law import MagnetLaw, Place
from mala_drake.ward.items import ITEM_HALF_HEIGHT


def boxes_at_pads(law: MagnetLaw, pads: Sequence[int]) -> BufferedFunction:
    """The generalized forces of the magnets of some pads, the boxes' weight and inertia being felt by arm and base.

    Its argument is a column of 19 + 13 k numbers for k pads: pose and velocity of the base (quaternion w, x, y, z,
    position, angular and translational velocity), pose and velocity of each pad's box alike, the arm's joint angles and
    their rates. Its result is a column of 9 + 6 k: torque and force on the base, torque and force on each box, torques
    of the three joints. SI units, in the world frame.
    """
    state = casadi.SX.sym("state", 19 + 13 * len(pads))
    values = casadi.vertsplit(state)
    base, angles, rates = values[:13], values[-6:-3], values[-3:]
    motion = gripper_motion(base, angles, rates)
    robot, boxes = casadi.SX.zeros(9), []
    for index, pad in enumerate(pads):
        box = values[13 * (index + 1) : 13 * (index + 2)]
        middle = motion.pad_position(pad)
        hanging = (middle[0], middle[1], middle[2] - PAD_RADIUS - ITEM_HALF_HEIGHT)
        torque, force = law.wrench(box, Place(hanging, motion.yaw, motion.velocity_at(middle), motion.yaw_rate))
        reaction = ((-torque[0], -torque[1], -torque[2]), (-force[0], -force[1], -force[2]))
        on_base, on_joints = motion.generalized_force((box[4], box[5], box[6]), *reaction)
        robot += casadi.vertcat(*on_base, *on_joints)
        boxes += [*torque, *force]
    result = casadi.vertcat(robot[:6], *boxes, robot[6:])
    return BufferedFunction(densified("boxes_at_pads", [state], [result]))
