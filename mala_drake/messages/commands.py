"""How the robot is to move."""

from __future__ import annotations

from dataclasses import dataclass

from mala_drake.messages.message import Message


@dataclass(frozen=True, slots=True)
class ArmCommand(Message):
    """Where the gripper is to be, in the robot's base frame, or stowed when `p_BG` is None. Metres."""

    p_BG: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class MagnetCommand(Message):
    """Which item bodies are wanted in the gripper's pads: (item, pad index) pairs; all others are let go."""

    held: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True, slots=True)
class PredictedTrajectory(Message):
    """The states the controller plans to go through: rows (x, y, yaw, v_x, v_y, omega_z)."""

    states: tuple[tuple[float, ...], ...] = ()
