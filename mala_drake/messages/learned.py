"""What is learned, and the leg that it is learned from."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from mala_drake.messages.actions import Action
from mala_drake.messages.message import Atom, Message
from mala_drake.messages.observations import Shape


@dataclass(frozen=True, slots=True)
class Preferences(Message):
    """Preference weights (time, safety, battery, proximity, approach) on the simplex.

    `planning` are the weights to plan with (with exploration), `estimate` the learner's own, `deviation` its standard
    deviation or None for a point estimate.
    """

    planning: tuple[float, ...] = (0.2,) * 5
    estimate: tuple[float, ...] = (0.2,) * 5
    deviation: tuple[float, ...] | None = None
    updates: int = 0


@dataclass(frozen=True, slots=True)
class LearnedCosts(Message):
    """The numbers that actions are predicted by, corrected by what actions really cost.

    `values` are ground fluents as in PDDL, and what they are believed to be. `leg_scales` tell how many times the
    predicted time, risk, charge and discomfort legs take in general. `updates` counts the actions learned from.
    """

    values: tuple[tuple[Atom, float], ...] = ()
    leg_scales: tuple[float, ...] = (1.0,) * 4
    updates: int = 0


class SensitivitySource(Enum):
    """Where a target's update has it from how the end of a leg moves with the target."""

    NONE = ""  # There was no update.
    SIMULATED = "simulated"  # From the leg, simulated in closed loop.
    FALLBACK = "fallback"  # The identity, because the simulation failed or what it says cannot be.
    IDENTITY = "identity"  # The identity, because nothing else is wanted.
    NOT_NEEDED = "not_needed"  # The leg was not driven to its end: the update is about where the robot is.


@dataclass(frozen=True, slots=True)
class LearnedTargets(Message):
    """Where legs to places really are to end, as (place, x, y), metres; places not named are where the map says.

    `sensitivity` is what the episode's newest update went through, `deviation` the 2-norm by which the sensitivity that
    was simulated for it differs from the identity; None if there was none.
    """

    targets: tuple[tuple[str, float, float], ...] = ()
    updates: int = 0  # In all.
    sensitivity: SensitivitySource = SensitivitySource.NONE
    deviation: float | None = None

    def pose(self, place: str, mapped: tuple[float, float, float]) -> tuple[float, float, float]:
        """Where a leg to a place is to end, if the map says `mapped`; both (x, y, yaw), and the yaw is the map's."""
        return next(((x, y, mapped[2]) for name, x, y in self.targets if name == place), mapped)


@dataclass(frozen=True, slots=True)
class LearnedDynamics(Message):
    """The coefficients p^f of the controller's model as learned, and their standard deviations; empty if nothing is.

    Both are in the order of `DynamicsParameters`. `updates` counts the samples learned from.
    """

    coefficients: tuple[float, ...] = ()
    deviations: tuple[float, ...] = ()
    updates: int = 0


@dataclass(frozen=True, slots=True)
class LearnedWeights(Message):
    """What costs the controller, as learned; empty if nothing is.

    `factors` are p^g by the place that an action leads to: on the position, yaw and velocity weights and on the control
    weights. `gains` are those of the translation from preferences to weights, 9 rows of 5, the diagonal of Q first.
    """

    factors: tuple[tuple[str, tuple[float, ...]], ...] = ()
    gains: tuple[tuple[float, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class DrivenLeg(Message):
    """A leg as it was driven: all that is needed to simulate it."""

    action: Action = Action()
    initial_state: tuple[float, ...] = (0.0,) * 6  # As the controller's model has it.
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)  # The pose that it was to end in: metres, radians.
    carrying: bool = False  # Whether the gripper held something.
    obstacles: tuple[Shape, ...] = ()  # What the sensor saw.
    preferences: tuple[float, ...] = (0.2,) * 5
    weights: LearnedWeights = LearnedWeights()
    dynamics: LearnedDynamics = LearnedDynamics()
