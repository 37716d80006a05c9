from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import mala_drake.control.sensitivities.kinks as mut
from mala_drake.control.sensitivities.stage_functions import StageFunctions
from mala_drake.messages import Shape


@pytest.fixture(scope="module")
def kinks(small):
    return mut.KinkDistances(StageFunctions(small))


def at(point, position, velocity=0.3, brake=0.0):
    """The point with all reached states and controls set: only distances are looked at."""
    states, controls = np.zeros_like(point.states), np.zeros_like(point.controls)
    states[:, :2], states[:, 3] = position, velocity
    controls[:, 1] = brake
    return replace(point, states=states, controls=controls)


@pytest.fixture(scope="module")
def beside(small, solve, start, choose):
    """A point beside a rectangle 2 by 1 with rounding 0.1: the required distance is 0.38."""
    box = Shape("box", 0.0, 0.0, 0.0, 1.0, 0.5, 0.1)
    chosen = choose(obstacles=(box,), speed_limits=np.full(4, 1.0), yaw_rate_limit=9.0, lateral_limit=9.0)
    far = solve(np.array([5.0, 5, 0, 0.3, 0, 0]), choose(obstacles=(), goal=np.array([5.3, 5, 0, 0.3, 0, 0])))
    return replace(far, parameters=chosen, packed=small.pack(np.zeros(6), chosen))


@pytest.mark.parametrize(
    ("position", "expected"),
    [
        ((0.0, 3.0), 0.65),  # Far away: from 0.3 m/s to 0.95 m/s, where the buffer of the speed limit begins.
        ((0.2, 0.5 + 0.1 + 0.38 + 0.05), 0.01),  # Just outside of the obstacle's buffer of 0.04.
        ((0.2, 0.5 + 0.1 + 0.38 + 0.013), 0.013),  # In the buffer, near the required distance.
        ((0.997, 0.5 + 0.1 + 0.38 + 0.02), 0.003),  # Where the side ends.
    ],
)
def test_the_nearest_change_of_curvature(kinks, beside, position, expected):
    distance = kinks.nearest(at(beside, position))
    assert distance == pytest.approx(expected, abs=1e-9)


def test_braking_into_reverse_counts_only_under_the_brake(kinks, beside):
    away = (0.0, 3.0)
    assert kinks.nearest(at(beside, away, velocity=-0.001, brake=0.5)) == pytest.approx(0.001)
    assert kinks.nearest(at(beside, away, velocity=-0.048, brake=0.5)) == pytest.approx(0.002)
    assert kinks.nearest(at(beside, away, velocity=-0.001, brake=0.0)) > 0.1


def test_corners_of_obstacles_out_of_reach_and_of_discs_do_not_count(kinks, beside, small):
    outside = at(beside, (0.9999, 0.5 + 0.1 + 0.38 + 0.3))
    assert kinks.nearest(outside) > 0.1
    disc = replace(
        beside.parameters,
        constraints=replace(beside.parameters.constraints, obstacles=(Shape("disc", 0, 0, radius=0.5),)),
    )
    point = replace(beside, parameters=disc, packed=small.pack(np.zeros(6), disc))
    assert kinks.nearest(at(point, (0.0, 0.5 + 0.38 + 0.02))) == pytest.approx(0.02, abs=1e-9)
