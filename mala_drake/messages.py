"""The immutable values on the diagram's abstract ports.

Drake deep-copies abstract state at each unrestricted update and abstract values at each evaluation; a frozen message
returns itself, so the copy is free. A message that starts something carries a sequence number that grows by one with
each new start; its receiver acts once on each. Sequence 0 means "nothing yet".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Any

Atom = tuple[str, ...]
"""A ground atom as in PDDL, for example `("at", "robot1", "home")`."""


class Message:
    """A value on an abstract port: immutable, so a copy is the value itself."""

    __slots__ = ()

    def __deepcopy__(self, memo: dict[int, Any]) -> Message:
        return self

    def __copy__(self) -> Message:
        return self


class ActionKind(Enum):
    """Who executes an action: nobody, the model predictive controller, or the in-place executor."""

    NONE = "none"
    MOVE = "move"
    IN_PLACE = "in_place"


class Outcome(Enum):
    """How an action ended."""

    RUNNING = "running"
    SUCCESS = "success"  # A leg: stopped at its target. An in-place action: its physical effect was seen.
    WAYPOINT_ALLOCATION = "waypoint_allocation"  # Too many iterations without reaching the next waypoint.
    STEP_BUDGET = "step_budget"  # Too many control steps in one leg.
    SOLVER_FAILURE = "solver_failure"  # The optimiser failed more often in a row than is tolerated.
    BLOCKED = "blocked"  # No free path to the target is left.
    INVALID_STATE = "invalid_state"  # The state estimate is not finite.
    OUT_OF_REACH = "out_of_reach"  # The arm cannot reach the item or the table from here.
    NOT_THERE = "not_there"  # The item was not where it was to be picked up, or did not stay where it was put.
    OUT_OF_STOCK = "out_of_stock"
    BATTERY_EMPTY = "battery_empty"
    CANCELLED = "cancelled"  # Replaced by a newer action.


@dataclass(frozen=True, slots=True)
class Task(Message):
    """What the scheduler wants done now. `sequence` counts the tasks of a run, from 1."""

    sequence: int = 0
    name: str = ""
    episode: int = 0


@dataclass(frozen=True, slots=True)
class Action(Message):
    """One planned action on its way to the layer that executes it.

    `place` is where the robot is expected to be after the action; `previous_place` where it was (empty in transit).
    """

    sequence: int = 0
    kind: ActionKind = ActionKind.NONE
    name: str = ""
    arguments: tuple[str, ...] = ()
    place: str = ""
    previous_place: str = ""

    @property
    def text(self) -> str:
        """The action as PDDL writes it, `(name arg ...)`."""
        return "(" + " ".join((self.name, *self.arguments)) + ")"


@dataclass(frozen=True, slots=True)
class TaskReport(Message):
    """What became of the task `sequence`; `failure` is empty on success."""

    sequence: int = 0
    finished: bool = False
    success: bool = False
    failure: str = ""
    actions: tuple[str, ...] = ()
    plan_cost: float = 0.0  # Of the first plan, at the planning weights.
    predicted_features: tuple[float, ...] = (0.0,) * 5  # Summed over executed actions, as predicted at dispatch.
    replans: int = 0
    mismatches: int = 0
    last_action: Action = Action()  # The newest of `actions`, and how it ended.
    last_outcome: Outcome = Outcome.RUNNING
    last_predicted: tuple[float, ...] = (0.0,) * 5  # Its features as predicted at dispatch.
    last_differing: tuple[Atom, ...] = ()  # The atoms, in lower case, that were expected after it or seen, not both.


@dataclass(frozen=True, slots=True)
class PlanMessage(Message):
    """The plan the planner is following: `actions` still to be done, the current one first."""

    sequence: int = 0
    status: str = "none"  # none | optimal | unsolvable | limit
    actions: tuple[str, ...] = ()
    cost: float = 0.0


@dataclass(frozen=True, slots=True)
class ActionReport(Message):
    """What became of the action `sequence`.

    The terminal errors are those of a leg: metres, radians, metres per second (and radians per second).
    """

    sequence: int = 0
    outcome: Outcome = Outcome.RUNNING
    steps: int = 0
    position_error: float = 0.0
    yaw_error: float = 0.0
    terminal_speed: float = 0.0
    closed_loop_cost: float = 0.0  # R^o = sum of G over the steps so far, and W of the reached state once it has ended.
    solves: int = 0
    failures: int = 0
    detail: str = ""
    shortfall: tuple[float, float] | None = None  # Of the arm: (dx, dy) in the world that is missing, metres.

    @property
    def finished(self) -> bool:
        """Whether the action has ended, well or badly."""
        return self.sequence > 0 and self.outcome is not Outcome.RUNNING


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
class ArmCommand(Message):
    """Where the gripper is to be, in the robot's base frame, or stowed when `p_BG` is None. Metres."""

    p_BG: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class MagnetCommand(Message):
    """Which item bodies are wanted in the gripper's pads: (item, pad index) pairs; all others are let go."""

    held: tuple[tuple[str, int], ...] = ()


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


@dataclass(frozen=True, slots=True)
class PredictedTrajectory(Message):
    """The states the controller plans to go through: rows (x, y, yaw, v_x, v_y, omega_z)."""

    states: tuple[tuple[float, ...], ...] = ()


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
class ActionFeatures(Message):
    """What a finished action really cost, unscaled, from its dispatch to the next one's.

    Seconds, risk, charge used and discomfort; for a hand-over also the approach error of the pose, without the looks of
    a dish.
    """

    action: Action = Action()
    outcome: Outcome = Outcome.RUNNING
    duration: float = 0.0
    risk: float = 0.0
    charge_used: float = 0.0
    discomfort: float = 0.0
    approach_error: float = 0.0


@dataclass(frozen=True, slots=True)
class ActionEvaluation(Message):
    """How a finished action turned out: its rewards R^e and R^o, and its mismatches E^psi and E^C.

    `weights` are the preferences that it was planned with, `prices` what they make of a second, a risk, a charge, a
    discomfort and an approach error. Rewards and costs are defined in `ActionMeter`.
    """

    action: Action = Action()
    outcome: Outcome = Outcome.RUNNING
    weights: tuple[float, ...] = (0.2,) * 5
    prices: tuple[float, ...] = (0.0,) * 5
    external_reward: float = 0.0  # R^e.
    closed_loop_cost: float | None = None  # R^o of a leg, None of an action in place.
    state_mismatch: float = 0.0  # E^psi, in [0, 1].
    cost_mismatch: float = 0.0  # E^C, positive for an action that cost more than predicted.


@dataclass(frozen=True, slots=True)
class LearnedCosts(Message):
    """The numbers that actions are predicted by, corrected by what actions really cost.

    `values` are ground fluents as in PDDL, and what they are believed to be. `leg_scales` tell how many times the
    predicted time, risk, charge and discomfort legs take in general. `updates` counts the actions learned from.
    """

    values: tuple[tuple[Atom, float], ...] = ()
    leg_scales: tuple[float, ...] = (1.0,) * 4
    updates: int = 0


@dataclass(frozen=True, slots=True)
class LearnedTargets(Message):
    """Where legs to places really are to end, as (place, x, y), metres; places not named are where the map says."""

    targets: tuple[tuple[str, float, float], ...] = ()
    updates: int = 0  # In all.


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


@dataclass(frozen=True, slots=True)
class EpisodeReport(Message):
    """One task as it was executed, for the patient, the learners and the record. `sequence` is the task's."""

    sequence: int = 0
    task: str = ""
    success: bool = False
    failure: str = ""
    actions: tuple[str, ...] = ()
    features: tuple[float, ...] = (0.0,) * 5
    predicted_features: tuple[float, ...] = (0.0,) * 5
    plan_cost: float = 0.0
    replans: int = 0
    mismatches: int = 0
    duration: float = 0.0  # Seconds.
    battery_start: float = 1.0
    battery_end: float = 1.0
    details: tuple[tuple[str, Any], ...] = field(default=())


@dataclass(frozen=True, slots=True)
class Ratings(Message):
    """The patient's ratings of episode `sequence`, one a feature; None where the patient did not rate."""

    sequence: int = 0
    values: tuple[float | None, ...] = ()
    features: tuple[float, ...] = ()
