"""How far what was reached is from what was expected, crisply and continuously (E^psi).

Paper, Sec. "Expected Location and Fuzzy Mismatch Detection" and "Updating the MPC Control Parametrization".
"""

from __future__ import annotations

import math

import numpy.typing as npt

from mala_drake.grounding.aggregation import state_truth, state_truth_gradient
from mala_drake.grounding.location import LocationMembership
from mala_drake.grounding.membership import AbstractMembership
from mala_drake.grounding.norms import AbstractNorms, FloatArray


def location_mismatch(fuzzy_place: str, expected_place: str) -> bool:
    """Whether l_fuzzy != l_expected.

    Args:
        fuzzy_place: where the grounding says the robot is; empty in transit, which is a mismatch too.
        expected_place: where the planner expects it; empty when it expects nothing, which nothing contradicts.
    """
    return bool(expected_place) and fuzzy_place != expected_place


def state_mismatch(
    values: npt.ArrayLike, observed: npt.ArrayLike, predicted: npt.ArrayLike, *, norms: AbstractNorms
) -> float:
    """E^psi: the degree to which the observed state is true, minus that of the predicted state.

    Zero when they agree; at most 1, and not negative when the observed state is the best one.

    Args:
        values: memberships at the reached continuous state, (M,).
        observed: crisp state observed, (M,), bool.
        predicted: crisp state the planner predicted, (M,), bool.
        norms: the logic.
    """
    return float(state_truth(values, observed, norms=norms) - state_truth(values, predicted, norms=norms))


def state_mismatch_gradient(
    values: npt.ArrayLike, observed: npt.ArrayLike, predicted: npt.ArrayLike, *, norms: AbstractNorms
) -> FloatArray:
    """The derivative of `state_mismatch` with respect to the memberships, (M,)."""
    return state_truth_gradient(values, observed, norms=norms) - state_truth_gradient(values, predicted, norms=norms)


def reach_error(membership: AbstractMembership, shortfall: tuple[float, float]) -> tuple[float, tuple[float, float]]:
    """The continuous mismatch 1 - mu of having something within reach, and its derivative.

    Args:
        membership: of how far the arm falls short, metres.
        shortfall: the way (dx, dy) in the world by which it does: moving along it makes it less.

    Returns:
        The mismatch, and its derivative with respect to the robot's position, 1/m; zero where nothing is missing.
    """
    distance = math.hypot(*shortfall)
    error = 1.0 - float(membership.value(distance))
    if distance == 0.0:
        return error, (0.0, 0.0)
    slope = float(membership.derivative(distance)) / distance
    return error, (slope * shortfall[0], slope * shortfall[1])


def location_error(location: LocationMembership, position: npt.ArrayLike) -> FloatArray:
    """The continuous mismatch 1 - mu of the expected `at` atom at the reached position, (...).

    It stays positive until the robot is on the plateau, where the crisp mismatch has long been gone.

    Args:
        location: the expected one.
        position: reached, (..., 2), metres.
    """
    return 1.0 - location.value(position)


def location_error_gradient(location: LocationMembership, position: npt.ArrayLike) -> FloatArray:
    """The derivative of `location_error` with respect to the reached position, (..., 2), 1/m."""
    return -location.gradient(position)
