"""The drive's inverse dynamics, against the rigid-body equations written out."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.clock import PLANT_STEP
from mala_drake.robot import drive_law as mut
from mala_drake.robot.robot_parameters import NOMINAL

LAW = mut.DriveLaw()
accelerations = st.floats(-2.0, 2.0)
brakes = st.floats(0.0, 2.0)
yaw_accelerations = st.floats(-1.0, 1.0)
speeds = st.floats(-30.0, 30.0)


def _accelerations(torques, left_speed, right_speed):
    """What the nominal robot does under the torques: forward, m/s^2, and about the vertical, rad/s^2.

    Newton's and Euler's equations of body and wheels that roll without slip.
    """
    p = NOMINAL
    left = torques[0] - p.wheel_damping * left_speed
    right = torques[1] - p.wheel_damping * right_speed
    forward = (left + right) / p.wheel_radius / (p.mass + 2.0 * p.wheel_inertia / p.wheel_radius**2)
    lever = p.half_track / p.wheel_radius
    turning = (right - left) * lever / (p.yaw_inertia + 2.0 * p.wheel_inertia * lever**2)
    return forward, turning


@given(propulsion=accelerations, yaw_acceleration=yaw_accelerations, left=speeds, right=speeds)
def test_the_nominal_robot_accelerates_as_commanded(propulsion, yaw_acceleration, left, right):
    torques = LAW.torques(propulsion, 0.0, yaw_acceleration, left, right)
    if max(map(abs, torques)) < NOMINAL.torque_limit:
        assert _accelerations(torques, left, right) == pytest.approx((propulsion, yaw_acceleration), abs=1e-9)


@given(brake=st.floats(0.1, 2.0), yaw_acceleration=yaw_accelerations, speed=st.floats(5.0, 20.0))
def test_a_rolling_robot_slows_down_by_the_brake(brake, yaw_acceleration, speed):
    torques = LAW.torques(0.0, brake, yaw_acceleration, speed, speed)
    expected = min(brake, NOMINAL.brake_limit)
    forward, turning = _accelerations(torques, speed, speed)
    if yaw_acceleration == 0.0:
        # Parked: the rolling resistance brakes too, and a weak brake cannot make it less.
        rolling = 2.0 * NOMINAL.wheel_damping * speed / NOMINAL.wheel_radius / NOMINAL.effective_mass
        expected = max(expected, rolling)
    assert (forward, turning) == pytest.approx((-expected, yaw_acceleration), abs=1e-9)


@given(brake=brakes, speed=speeds, turn=st.floats(-5.0, 5.0))
def test_one_step_of_braking_never_reverses(brake, speed, turn):
    left, right = speed - turn, speed + turn
    for yaw_acceleration in (0.0, 1e-9):
        torques = LAW.torques(0.0, brake, yaw_acceleration, left, right)
        forward, _ = _accelerations(torques, left, right)
        velocity = NOMINAL.wheel_radius * speed
        after = velocity + PLANT_STEP * forward
        assert after * velocity >= -1e-12
        assert abs(after) <= abs(velocity) + 1e-12


@given(control=st.tuples(st.floats(), st.floats(), st.floats()), left=speeds, right=speeds, powered=st.booleans())
def test_torques_are_finite_and_within_the_limit_whatever_is_commanded(control, left, right, powered):
    for torque in LAW.torques(*control, left, right, powered=powered):
        assert abs(torque) <= NOMINAL.torque_limit


@given(bad=st.sampled_from([math.nan, math.inf, -math.inf]), entry=st.integers(0, 2), left=speeds, right=speeds)
def test_commands_that_are_not_finite_park(bad, entry, left, right):
    control = [0.3, 0.0, 0.1]
    control[entry] = bad
    assert LAW.torques(*control, left, right) == LAW.torques(0.0, NOMINAL.brake_limit, 0.0, left, right)


@given(propulsion=accelerations, yaw_acceleration=yaw_accelerations, left=speeds, right=speeds)
def test_without_power_the_drive_does_no_work(propulsion, yaw_acceleration, left, right):
    torques = LAW.torques(propulsion, 0.0, yaw_acceleration, left, right, powered=False)
    assert torques[0] * left <= 0.0
    assert torques[1] * right <= 0.0


def test_power_is_mechanical_work_and_heat_and_braking_is_free():
    p = NOMINAL
    assert LAW.power((2.0, 3.0), 10.0, 5.0) == pytest.approx(35.0 / p.drive_efficiency + p.copper_loss * 13.0)
    assert LAW.power((-2.0, -3.0), 10.0, 5.0) == 0.0
    assert LAW.power((-2.0, -2.0), -1.0, -1.0) == pytest.approx(4.0 / p.drive_efficiency + p.copper_loss * 8.0)


def test_cruising_overcomes_the_rolling_resistance():
    force = 2.0 * NOMINAL.wheel_damping * 15.0 / NOMINAL.wheel_radius
    assert 15.0 < force < 25.0
    assert LAW.cruise_power(1.5) > force * 1.5
