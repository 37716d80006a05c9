"""What the planner makes of learned costs (rows F2, F3): theta^C and theta^T replace the predictions of the map.

Costs become what was learned. A charge that a precondition reads may only grow: it is the largest of the map's
prediction, the most that was lately measured and the learned mean, and the charge kept for the way to a charger follows
from those. So learning never makes a plan possible that the map alone would have refused for want of charge, and a leg
that has been seen to take more than predicted is planned with more.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from mala_drake.messages import LearnedCosts
from mala_drake.planning.leg_costs import LegCost
from mala_drake.planning.state import Amount, Name
from mala_drake.planning.syntax import Fact
from mala_drake.ward.cost_parameters import CHARGE_NAMES, LEG_RESERVE

NOTHING_LEARNED = LearnedCosts()
"""All costs are as predicted."""

_LEG_CHARGE = "nav-charge"
_KEPT = "nearest-charger-battery"  # Of a location: charge that must be left there, 0 at a charger.


def learned_fluents(predicted: Mapping[Fact, Fraction], learned: LearnedCosts) -> dict[Name, Amount]:
    """The fluents of a task that are to have other values than the predicted ones.

    Args:
        predicted: all fluents of the task by the map.
        learned: from the cost learner; fluents that the task does not have are left out.
    """
    values: dict[Fact, Amount] = {name: value for name, value in learned.values if name in predicted}
    for name in [each for each in values if each[0] in CHARGE_NAMES]:
        values[name] = max(predicted[name], values[name], key=float)
    for name in [each for each in values if each[0] == LEG_RESERVE]:
        values[name] = max(values[name], values.get((_LEG_CHARGE, *name[1:]), 0), key=float)
    values |= _kept(predicted, values)
    return {name: value for name, value in values.items()}  # noqa: C416 (another type of key)


def learned_leg(cost: LegCost, learned: LearnedCosts) -> LegCost:
    """A leg that has never been driven: as much more or less than predicted as legs take in general."""
    time, risk, charge, discomfort = learned.leg_scales
    return replace(
        cost,
        time=time * cost.time,
        risk=risk * cost.risk,
        charge=charge * cost.charge,
        discomfort=discomfort * cost.discomfort,
    )


def _kept(predicted: Mapping[Fact, Fraction], values: Mapping[Fact, Amount]) -> dict[Fact, Amount]:
    """The charge to be left at each location, for the nearest charger as the legs to it are known now."""
    places = {name[1]: least for name, least in predicted.items() if name[0] == _KEPT}
    chargers = [place for place, least in places.items() if least == 0]
    kept: dict[Fact, Amount] = {}
    for place, least in places.items():
        ways = [(LEG_RESERVE, place, charger) for charger in chargers]
        known = [values.get(way, predicted[way]) for way in ways if way in predicted]
        if least > 0 and known:
            kept[(_KEPT, place)] = max(least, min(known, key=float), key=float)
    return kept
