"""The smooth charge rate against the drive law that the battery is drained by."""

from __future__ import annotations

import casadi
import numpy as np
import pytest

from mala_drake.robot.battery import CAPACITY, CHARGE_PER_METRE
from mala_drake.robot.drive_charge import charge_rate
from mala_drake.robot.drive_law import DriveLaw
from mala_drake.robot.robot_parameters import NOMINAL
from mala_drake.ward.congestion import CRUISE_SPEED

motion, command = (tuple(casadi.SX.sym(name, size)[i] for i in range(size)) for name, size in (("m", 2), ("c", 3)))
RATE = casadi.Function("rate", [*motion, *command], [charge_rate(motion, command)])


def smooth(speed, yaw_rate, *told):
    return float(RATE(speed, yaw_rate, *told))


def exact(speed, yaw_rate, *told):
    spins = [(speed + side * NOMINAL.half_track * yaw_rate) / NOMINAL.wheel_radius for side in (-1.0, 1.0)]
    law = DriveLaw()
    return law.power(law.torques(*told, *spins), *spins) / CAPACITY


def test_a_metre_at_cruise_costs_what_the_battery_says():
    assert smooth(CRUISE_SPEED, 0.0, 0.0, 0.0, 0.0) / CRUISE_SPEED == pytest.approx(CHARGE_PER_METRE, rel=1e-3)


@pytest.mark.parametrize(
    ("speed", "yaw_rate", "propulsion", "brake", "turning"),
    [
        (1.2, 0.0, 0.8, 0.0, 0.0),
        (0.5, 0.2, 1.5, 0.0, 0.5),
        (1.4, -0.1, 0.0, 0.0, -0.3),
        (1.3, 0.0, 0.0, 1.5, 0.0),
        (0.8, 0.0, 0.2, 0.1, 0.0),
        (-0.3, 0.0, -0.5, 0.0, 0.0),
        (0.0, 0.9, 0.0, 0.0, 0.6),
        (1.0, 0.0, 0.1, 1.0, 0.2),
    ],
)
def test_it_is_that_of_the_drive_law_where_no_case_changes(speed, yaw_rate, propulsion, brake, turning):
    told = propulsion, brake, turning
    scale = CHARGE_PER_METRE * CRUISE_SPEED
    assert smooth(speed, yaw_rate, *told) == pytest.approx(exact(speed, yaw_rate, *told), rel=0.02, abs=0.02 * scale)


def test_standing_costs_nothing_and_braking_next_to_nothing():
    assert smooth(0.0, 0.0, 0.0, 2.0, 0.0) == pytest.approx(0.0, abs=1e-9)
    assert smooth(1.0, 0.0, 0.0, 2.0, 0.0) < 1e-3 * smooth(1.0, 0.0, 0.0, 0.0, 0.0)


def test_its_derivatives_are_finite_everywhere():
    symbols = casadi.vertcat(*motion, *command)
    gradient = casadi.Function("gradient", [symbols], [casadi.gradient(charge_rate(motion, command), symbols)])
    for point in np.random.default_rng(0).normal(size=(20, 5)) * [1.0, 1.0, 1.0, 1.0, 1.0]:
        assert np.isfinite(gradient(point).full()).all()
    assert np.isfinite(gradient(np.zeros(5)).full()).all()
