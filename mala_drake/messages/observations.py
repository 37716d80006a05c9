"""What the robot senses, and what it makes of it."""

from __future__ import annotations

from dataclasses import dataclass

from mala_drake.messages.message import Atom, Message


@dataclass(frozen=True, slots=True)
class RobotState(Message):
    """The estimated state of the MPC's model: metres, radians, and body-frame velocities."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    forward_velocity: float = 0.0
    lateral_velocity: float = 0.0
    yaw_rate: float = 0.0


@dataclass(frozen=True, slots=True)
class Memberships(Message):
    """Fuzzy truth of the atoms that the grounding knows, in a fixed order."""

    atoms: tuple[Atom, ...] = ()
    values: tuple[float, ...] = ()

    def value(self, atom: Atom) -> float:
        """The membership of `atom`, 0 when it is not grounded."""
        return dict(zip(self.atoms, self.values, strict=True)).get(atom, 0.0)


@dataclass(frozen=True, slots=True)
class SymbolicState(Message):
    """The crisp state observed: sorted atoms that hold, the fuzzy location (empty in transit) and the charge."""

    atoms: tuple[Atom, ...] = ()
    place: str = ""
    charge: float = 1.0  # State of charge in [0, 1].


@dataclass(frozen=True, slots=True)
class PlaceMismatch(Message):
    """How far the robot is from where the action under way needs it; place "" is none.

    The atom that is missing is that of being at the place, or that of having the place's things within reach.
    """

    place: str = ""
    error: float = 0.0  # 1 - mu of the atom, E^psi in its continuous form.
    gradient: tuple[float, float] = (0.0, 0.0)  # Of the error, by the robot's position, 1/m.
    offset: tuple[float, float] | None = None  # From the robot to the place, metres; None out of sight.


@dataclass(frozen=True, slots=True)
class WorldFacts(Message):
    """What the robot's sensors have established about the world (not the truth the world keeps to itself).

    `atoms` are sorted.
    """

    atoms: tuple[Atom, ...] = ()
    sequence: int = 0  # Of the last in-place action whose effects are in `atoms`.


@dataclass(frozen=True, slots=True)
class Shape(Message):
    """A vertical prism seen from above: an oriented rectangle with rounded corners (a disc has zero half sizes)."""

    name: str = ""
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    half_length: float = 0.0  # Along its own x, metres.
    half_width: float = 0.0  # Along its own y, metres.
    radius: float = 0.0  # Rounding, metres.


@dataclass(frozen=True, slots=True)
class Obstacles(Message):
    """The shapes that the obstacle sensor sees."""

    shapes: tuple[Shape, ...] = ()
