"""What holding a box does to box and robot, compiled: the magnet needs it at every step of the plant."""

from __future__ import annotations

import casadi

from mala_drake.buffered_function import BufferedFunction, densified
from mala_drake.robot.arm_kinematics import PAD_RADIUS
from mala_drake.robot.gripper_motion import gripper_motion
from mala_drake.robot.magnet_law import MagnetLaw, Place
from mala_drake.ward.items import ITEM_HALF_HEIGHT


def box_at_pad(law: MagnetLaw, pad: int) -> BufferedFunction:
    """The generalized forces of the magnet of a pad, the weight and inertia of the box being felt by arm and base.

    Its argument is a column of 32 numbers: pose and velocity of the base (quaternion w, x, y, z, position, angular and
    translational velocity), pose and velocity of the box alike, the arm's joint angles and their rates. Its result is a
    column of 15: torque and force on the base, torque and force on the box, torques of the three joints. SI units, in
    the world frame.
    """
    state = casadi.SX.sym("state", 32)
    values = casadi.vertsplit(state)
    base, box, angles, rates = values[:13], values[13:26], values[26:29], values[29:]
    motion = gripper_motion(base, angles, rates)
    middle = motion.pad_position(pad)
    hanging = (middle[0], middle[1], middle[2] - PAD_RADIUS - ITEM_HALF_HEIGHT)
    torque, force = law.wrench(box, Place(hanging, motion.yaw, motion.velocity_at(middle), motion.yaw_rate))
    reaction = ((-torque[0], -torque[1], -torque[2]), (-force[0], -force[1], -force[2]))
    on_base, on_joints = motion.generalized_force((box[4], box[5], box[6]), *reaction)
    result = casadi.vertcat(*on_base, *torque, *force, *on_joints)
    return BufferedFunction(densified("box_at_pad", [state], [result]))
