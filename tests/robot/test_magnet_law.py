"""The magnet's force: the closed form of a damped oscillator, its limits, and Drake's rotations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RollPitchYaw, RotationMatrix

from mala_drake.clock import PLANT_STEP
from mala_drake.robot import magnet_law as mut
from mala_drake.robot.items import ITEM_INERTIA, ITEM_MASS

LAW = mut.MagnetLaw()
STRICT = mut.MagnetLaw(either_way_round=False)
WEIGHT = ITEM_MASS * mut.GRAVITY
yaws = st.floats(-3.1, 3.1)


def _box(*, position=(0.0, 0.0, 0.0), rotation=None, norm=1.0, velocity=(0.0,) * 6):
    quaternion = (rotation or RotationMatrix()).ToQuaternion().wxyz()
    return [*(norm * quaternion), *position, *velocity]


def test_at_its_place_only_the_weight_is_carried():
    torque, force = LAW.wrench(_box(), mut.Place((0.0, 0.0, 0.0), 0.0))
    assert torque == pytest.approx((0.0, 0.0, 0.0))
    assert force == pytest.approx((0.0, 0.0, WEIGHT))


@pytest.mark.parametrize("step", [PLANT_STEP, 0.01, 0.001])
def test_a_box_out_of_place_returns_critically_damped(step):
    """Stepped as the plant steps it, with errors of first order, against x(t) = x0 (1 + omega t) exp(-omega t)."""
    z, v = 0.02, 0.0
    for i in range(1, round(0.6 / step) + 1):
        _, (_, _, f_z) = LAW.wrench(_box(position=(0, 0, z), velocity=(0, 0, 0, 0, 0, v)), mut.Place((0, 0, 0), 0.0))
        v += step * (f_z - WEIGHT) / ITEM_MASS
        z += step * v
        t = i * step
        assert z == pytest.approx(0.02 * (1 + LAW.frequency * t) * math.exp(-LAW.frequency * t), abs=0.18 * step)
    assert abs(z) < 1e-5


@given(distance=st.floats(0.0, 1.0))
def test_it_lets_go_beyond_its_reach(distance):
    _, force = LAW.wrench(_box(position=(distance, 0.0, 0.0)), mut.Place((0.0, 0.0, 0.0), 0.0))
    if distance > LAW.reach:
        assert force == (0.0, 0.0, 0.0)
    else:
        assert force == pytest.approx((-ITEM_MASS * LAW.frequency**2 * distance, 0.0, WEIGHT), abs=1e-9)


@given(distance=st.floats(0.0, 10.0))
def test_the_spring_is_never_stronger_than_its_strength(distance):
    law = mut.MagnetLaw(reach=math.inf)
    _, (f_x, _, _) = law.wrench(_box(position=(distance, 0.0, 0.0)), mut.Place((0.0, 0.0, 0.0), 0.0))
    assert -law.strength - 1e-9 <= f_x <= 0.0


def test_a_box_that_is_nowhere_is_not_pulled():
    torque, force = LAW.wrench(_box(position=(math.nan, 0.0, 0.0)), mut.Place((0.0, 0.0, 0.0), 0.0))
    assert torque == force == (0.0, 0.0, 0.0)


def test_a_box_that_moves_with_its_place_is_not_braked():
    place = mut.Place((0.0, 0.0, 0.0), 0.0, velocity=(1.2, -0.4, 0.1), yaw_rate=0.7)
    torque, force = LAW.wrench(_box(velocity=(0.0, 0.0, 0.7, 1.2, -0.4, 0.1)), place)
    assert torque == pytest.approx((0.0, 0.0, 0.0))
    assert force == pytest.approx((0.0, 0.0, WEIGHT))


@given(
    yaw=yaws,
    axis=st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda a: np.linalg.norm(a) > 0.1),
    angle=st.floats(-0.1, 0.1),
    norm=st.floats(0.8, 1.25),
    sign=st.sampled_from([-1.0, 1.0]),
)
def test_the_torque_turns_the_box_back(yaw, axis, angle, norm, sign):
    """A small rotation away from the place gives a torque of -I omega^2 times it, whatever the quaternion's norm."""
    unit = np.array(axis) / np.linalg.norm(axis)
    deviation = RotationMatrix(AngleAxis(angle, unit))
    rotation = deviation @ RotationMatrix.MakeZRotation(yaw)
    torque, _ = STRICT.wrench(_box(rotation=rotation, norm=sign * norm), mut.Place((0.0, 0.0, 0.0), yaw))
    expected = -ITEM_INERTIA * STRICT.frequency**2 * 2.0 * math.sin(0.5 * angle) * unit
    assert torque == pytest.approx(expected, abs=1e-9)


@given(yaw=yaws, box_yaw=yaws)
def test_a_box_is_not_turned_by_more_than_a_quarter_when_either_way_will_do(yaw, box_yaw):
    rotation = RotationMatrix(RollPitchYaw(0.0, 0.0, box_yaw))
    torque, _ = LAW.wrench(_box(rotation=rotation), mut.Place((0.0, 0.0, 0.0), yaw))
    turn = math.remainder(yaw - box_yaw, math.pi)
    if abs(abs(turn) - 0.5 * math.pi) > 1e-6:
        expected = 2.0 * math.sin(0.5 * turn) * ITEM_INERTIA * LAW.frequency**2
        assert torque == pytest.approx((0.0, 0.0, expected), abs=1e-9)
