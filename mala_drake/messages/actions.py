"""What is to be done, from the task down to a single action, and what has become of it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from mala_drake.messages.message import Atom, Message


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

    The terminal errors are those of a leg that has ended, in metres, radians and metres per second. One is None where
    nothing was measured: of a place that nobody knows, or of a state that was not finite.
    """

    sequence: int = 0
    outcome: Outcome = Outcome.RUNNING
    steps: int = 0
    position_error: float | None = None
    yaw_error: float | None = None
    terminal_speed: float | None = None
    closed_loop_cost: float = 0.0  # R^o = sum of G over the steps so far, and W of the reached state once it has ended.
    solves: int = 0
    failures: int = 0  # Solves that the robot was not driven with: it braked instead.
    not_converged: int = 0  # Solves that stopped at their iteration limit, and that it was driven with.
    detail: str = ""
    shortfall: tuple[float, float] | None = None  # Of the arm: (dx, dy) in the world that is missing, metres.

    @property
    def finished(self) -> bool:
        """Whether the action has ended, well or badly."""
        return self.sequence > 0 and self.outcome is not Outcome.RUNNING
