"""The parameters of the predicted costs: which numbers of the planning domains an executed action tells something of.

theta^C of the paper's stage cost Phi^C(theta^C; s, a) are time, risk, charge and discomfort of each leg, time and
charge of each action done in place, and the discomfort of standing at a bedside. theta^T of its terminal cost
Phi^T(theta^T; s_n) is the approach error of each bedside; the total time, which is in the terminal cost too, is the
sum of the actions' times and has no parameter of its own, or one error would be corrected twice. A parameter is named
by its ground fluent. Places are spelled as in the domains, in lower case.
"""

from __future__ import annotations

from mala_drake.messages import ActionFeatures, ActionKind, Atom, Outcome
from mala_drake.ward.in_place_actions import DELIVERING, Verb, in_place_action

LEG_COSTS = ("nav-time", "location-safety", "nav-charge", "proximity-feature")
"""Fluents of a leg that its cost is made of: seconds, risk, charge used, discomfort."""

LEG_RESERVE = "nav-battery"
"""Fluent of a leg that preconditions read: the charge to count on."""

APPROACH_ERROR, STANDING_DISCOMFORT = "approach-feature", "standing-proximity"
"""Fluents of a bedside: the approach error, and the discomfort per second of standing there."""


def location_name(place: str) -> str:
    """The planning domains' name of a place of the map."""
    return place.lower()


def time_name(verb: Verb) -> str:
    """The fluent of an in-place action's seconds."""
    return verb.value.replace("_", "-") + "-time"


def charge_name(verb: Verb) -> str:
    """The fluent of an in-place action's charge, of its cost and its preconditions alike."""
    return verb.value.replace("_", "-") + "-battery"


CHARGE_NAMES = frozenset({LEG_RESERVE, *map(charge_name, Verb)})
"""The fluents that preconditions on the battery read."""

LEARNED_NAMES = frozenset({*LEG_COSTS, *CHARGE_NAMES, *map(time_name, Verb), APPROACH_ERROR, STANDING_DISCOMFORT})
"""The fluents that can be learned, by name."""


def observed_parameters(features: ActionFeatures) -> dict[Atom, float]:
    """What a finished action says of the parameters that predicted it; nothing if it failed.

    A leg that began in transit has no parameters of its own: it was predicted from where the robot was.
    """
    if features.outcome is not Outcome.SUCCESS:
        return {}
    return _of_leg(features) if features.action.kind is ActionKind.MOVE else _of_work(features)


def _of_leg(features: ActionFeatures) -> dict[Atom, float]:
    if not features.action.previous_place:
        return {}
    way = location_name(features.action.previous_place), location_name(features.action.place)
    measured = (features.duration, features.risk, features.charge_used, features.discomfort)
    observed: dict[Atom, float] = {(name, *way): value for name, value in zip(LEG_COSTS, measured, strict=True)}
    return observed | {(LEG_RESERVE, *way): features.charge_used}


def _of_work(features: ActionFeatures) -> dict[Atom, float]:
    work = in_place_action(features.action.name, features.action.arguments)
    if work is None:
        return {}
    about = (work.dish,) if work.verb is Verb.ASSEMBLE else ()
    observed: dict[Atom, float] = {(time_name(work.verb), *about): features.duration}
    if work.verb is not Verb.RECHARGE:
        observed[(charge_name(work.verb), *about)] = features.charge_used
    if work.verb in DELIVERING:
        bedside = location_name(features.action.place)
        observed[(APPROACH_ERROR, bedside)] = features.approach_error
        observed[(STANDING_DISCOMFORT, bedside)] = features.discomfort / features.duration
    return observed
