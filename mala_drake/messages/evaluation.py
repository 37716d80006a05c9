"""How actions and episodes have turned out, as measured and as the patient feels it."""

from __future__ import annotations

from dataclasses import dataclass

from mala_drake.messages.actions import Action, Outcome
from mala_drake.messages.message import Message


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


@dataclass(frozen=True, slots=True)
class Ratings(Message):
    """The patient's ratings of episode `sequence`, one a feature; None where the patient did not rate."""

    sequence: int = 0
    values: tuple[float | None, ...] = ()
    features: tuple[float, ...] = ()
