"""The membership functions of the care robot's atoms: with degrees of truth, or without."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from mala_drake.errors import BadInput
from mala_drake.grounding.alpha_cut import AlphaCut
from mala_drake.grounding.membership import AbstractMembership
from mala_drake.grounding.predicates import AbstractPredicateMembership, ChargeMembership
from mala_drake.grounding.saturated_ramp import SaturatedRamp

AT_A_PLACE = SaturatedRamp()
"""Of the distance to a place, metres (paper, Sec. "Fuzzy State Estimation")."""

WITHIN_REACH = SaturatedRamp(full=0.0, zero=4.0)
"""Of how far the arm falls short of what an action is about, metres; it falls as `AT_A_PLACE` does."""

_KINDS: Mapping[str, Callable[[AbstractMembership], AbstractMembership]] = MappingProxyType(
    {"fuzzy": lambda membership: membership, "crisp": AlphaCut}
)

MEMBERSHIP_NAMES = tuple(_KINDS)


def location_membership(kind: str) -> AbstractMembership:
    """The membership of being at a place, as a function of the distance in metres.

    Raises:
        BadInput: if the kind is not one of `MEMBERSHIP_NAMES`.
    """
    return _of_kind(kind)(AT_A_PLACE)


def predicate_memberships(kind: str, *, robot: str = "robot1") -> dict[str, AbstractPredicateMembership]:
    """The membership of each predicate that is a matter of degree, by its name.

    Raises:
        BadInput: if the kind is not one of `MEMBERSHIP_NAMES`.
    """
    low = ChargeMembership(("battery-low", robot))
    return {"battery-low": replace(low, membership=_of_kind(kind)(low.membership))}


def _of_kind(kind: str) -> Callable[[AbstractMembership], AbstractMembership]:
    if kind not in _KINDS:
        raise BadInput("grounding.membership", repr(kind), "one of " + ", ".join(MEMBERSHIP_NAMES))
    return _KINDS[kind]
