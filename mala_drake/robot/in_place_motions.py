"""The arm's motions of the in-place actions, as data: where the gripper is, and when the magnet is on.

An action runs through the phases of its motion by the fraction of its time that has passed. Fractions leave the arm
time for its way: about 1.8 s between the deck and a ledge, 0.5 s down to a box.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from mala_drake.robot.arm_kinematics import STOWED_POSITION, Point
from mala_drake.ward.in_place_actions import Verb

HOVER_HEIGHT = 0.13
"""Metres above its goal at which the gripper comes and goes: what hangs at it passes over boxes of 0.10 m."""

NOD: Point = (STOWED_POSITION[0] + 0.03, 0.0, STOWED_POSITION[2] + 0.05)
"""Where in the base frame the gripper goes for a moment when the robot has made up its mind."""

CAMERA: Point = (0.30, 0.0, 1.06)
"""Where in the base frame the gripper shows a box to the camera above the robot's face."""


class Aim(Enum):
    """Where the gripper is to be."""

    STOW = "stow"
    HOVER = "hover"  # Above the goal.
    GOAL = "goal"
    CAMERA = "camera"
    NOD = "nod"


@dataclass(frozen=True, slots=True)
class Phase:
    """One phase: until which fraction of the action, where the gripper is, whether the action's boxes are held.

    `offset` is from the goal: metres ahead, to the left and upwards, in the base frame.
    """

    until: float
    aim: Aim
    holding: bool
    offset: Point = (0.0, 0.0, 0.0)


def _work(*steps: tuple[float, Point]) -> tuple[Phase, ...]:
    """Both boxes are held and moved about the goal, then stowed."""
    return (*(Phase(until, Aim.GOAL, True, offset) for until, offset in steps), Phase(1.00, Aim.STOW, True))


def _put(above: float, down: float, released: float, away: float) -> tuple[Phase, ...]:
    """Boxes are brought above their goal, down to it and let go; the arm is raised from them and stowed."""
    return (
        Phase(above, Aim.HOVER, True),
        Phase(down, Aim.GOAL, True),
        Phase(released, Aim.GOAL, False),
        Phase(away, Aim.HOVER, False),
        Phase(1.00, Aim.STOW, False),
    )


_COLLECT = (
    Phase(0.38, Aim.HOVER, False),
    Phase(0.48, Aim.GOAL, False),
    Phase(0.52, Aim.GOAL, True),
    Phase(0.64, Aim.HOVER, True),
    Phase(1.00, Aim.STOW, True),
)
_SHOW = (Phase(0.55, Aim.CAMERA, True), Phase(1.00, Aim.STOW, True))

MOTIONS: dict[Verb, tuple[Phase, ...]] = {
    Verb.COLLECT: _COLLECT,
    Verb.CHECK: _SHOW,
    Verb.PUT_DOWN: _put(0.54, 0.74, 0.80, 0.98),
    Verb.DELIVER: _put(0.14, 0.22, 0.30, 0.36),
    Verb.RECHARGE: (Phase(1.00, Aim.STOW, False),),
    Verb.CHOOSE: (Phase(1.00, Aim.NOD, False),),
    Verb.COLLECT_INGREDIENT: _COLLECT,
    Verb.CHECK_INGREDIENTS: _SHOW,
    # A wipe over the counter, to and fro.
    Verb.SANITIZE: _work((0.42, (0.0, 0.15, 0.08)), (0.60, (0.0, -0.15, 0.08))),
    # Dipped into the basin twice.
    Verb.WASH: _work((0.38, (0.0, 0.0, 0.05)), (0.48, (0.0, 0.0, 0.14)), (0.58, (0.0, 0.0, 0.05))),
    # Three strokes over the board.
    Verb.CHOP: _work(
        (0.26, (0.0, 0.0, 0.14)),
        (0.34, (0.0, 0.0, 0.06)),
        (0.42, (0.0, 0.0, 0.14)),
        (0.50, (0.0, 0.0, 0.06)),
        (0.58, (0.0, 0.0, 0.14)),
        (0.66, (0.0, 0.0, 0.06)),
        (0.72, (0.0, 0.0, 0.14)),
    ),
    # Held before the plates, and stirred.
    Verb.COOK: _work(
        (0.50, (0.08, 0.0, 0.18)), (0.60, (0.08, 0.06, 0.18)), (0.70, (0.08, -0.06, 0.18)), (0.80, (0.08, 0.0, 0.18))
    ),
    Verb.CHECK_COOKING_LEVEL: _SHOW,
    Verb.CHECK_PALATABILITY: _SHOW,
    # Brought together on the plate, a little from each side.
    Verb.ASSEMBLE: _work((0.38, (0.0, 0.04, 0.04)), (0.48, (0.0, -0.04, 0.04)), (0.62, (0.0, 0.0, 0.12))),
    Verb.SERVE: _put(0.28, 0.42, 0.54, 0.64),
}
"""The phases of each verb; the last one ends with the action."""


def phase_index(verb: Verb, fraction: float) -> int:
    """Which phase of the motion it is when `fraction` of the action has passed."""
    phases = MOTIONS[verb]
    for index, phase in enumerate(phases):
        if fraction < phase.until:
            return index
    return len(phases) - 1


def gripper_target(phase: Phase, goal: Point | None) -> Point | None:
    """Where the gripper is to be in the base frame, None for stowed; `goal` is where it does its work.

    Raises:
        ValueError: the phase needs a goal and there is none.
    """
    if phase.aim is Aim.STOW:
        return None
    if phase.aim in (Aim.CAMERA, Aim.NOD):
        return CAMERA if phase.aim is Aim.CAMERA else NOD
    if goal is None:
        raise ValueError(f"{phase.aim} without a goal")
    x, y, z = (a + b for a, b in zip(goal, phase.offset, strict=True))
    return (x, y, z) if phase.aim is Aim.GOAL else (x, y, z + HOVER_HEIGHT)


def works_about_goal(verb: Verb) -> bool:
    """Whether the boxes in the gripper are moved about a goal and kept."""
    phases = MOTIONS[verb]
    return all(phase.holding for phase in phases) and any(phase.aim is Aim.GOAL for phase in phases)
