"""The arm's motions of the in-place actions, as data: where the gripper is, and when the magnet is on.

An action runs through the phases of its motion by the fraction of its time that has passed. Fractions leave the arm
time for its way: about 1.8 s between the deck and a ledge, 0.5 s down to a box.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from mala_drake.robot.arm_kinematics import Point
from mala_drake.ward.in_place_actions import Verb

HOVER_HEIGHT = 0.13
"""Metres above its goal at which the gripper comes and goes: what hangs at it passes over boxes of 0.10 m."""

CAMERA: Point = (0.30, 0.0, 1.06)
"""Where in the base frame the gripper shows a box to the camera above the robot's face."""


class Aim(Enum):
    """Where the gripper is to be."""

    STOW = "stow"
    HOVER = "hover"  # Above the goal.
    GOAL = "goal"
    CAMERA = "camera"


@dataclass(frozen=True, slots=True)
class Phase:
    """One phase: until which fraction of the action, where the gripper is, whether the action's boxes are held."""

    until: float
    aim: Aim
    holding: bool


MOTIONS: dict[Verb, tuple[Phase, ...]] = {
    Verb.COLLECT: (
        Phase(0.38, Aim.HOVER, False),
        Phase(0.48, Aim.GOAL, False),
        Phase(0.52, Aim.GOAL, True),
        Phase(0.64, Aim.HOVER, True),
        Phase(1.00, Aim.STOW, True),
    ),
    Verb.CHECK: (Phase(0.55, Aim.CAMERA, True), Phase(1.00, Aim.STOW, True)),
    Verb.PUT_DOWN: (
        Phase(0.54, Aim.HOVER, True),
        Phase(0.74, Aim.GOAL, True),
        Phase(0.80, Aim.GOAL, False),
        Phase(0.98, Aim.HOVER, False),
        Phase(1.00, Aim.STOW, False),
    ),
    Verb.DELIVER: (
        Phase(0.14, Aim.HOVER, True),
        Phase(0.22, Aim.GOAL, True),
        Phase(0.30, Aim.GOAL, False),
        Phase(0.36, Aim.HOVER, False),
        Phase(1.00, Aim.STOW, False),
    ),
    Verb.RECHARGE: (Phase(1.00, Aim.STOW, False),),
}
"""The phases of each verb; the last one ends with the action."""


def phase_index(verb: Verb, fraction: float) -> int:
    """Which phase of the motion it is when `fraction` of the action has passed."""
    phases = MOTIONS[verb]
    for index, phase in enumerate(phases):
        if fraction < phase.until:
            return index
    return len(phases) - 1


def gripper_target(aim: Aim, goal: Point | None) -> Point | None:
    """Where the gripper is to be in the base frame, None for stowed; `goal` is where it does its work.

    Raises:
        ValueError: the aim needs a goal and there is none.
    """
    if aim is Aim.STOW:
        return None
    if aim is Aim.CAMERA:
        return CAMERA
    if goal is None:
        raise ValueError(f"{aim} without a goal")
    return goal if aim is Aim.GOAL else (goal[0], goal[1], goal[2] + HOVER_HEIGHT)
