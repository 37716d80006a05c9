"""The layout of the robot's state port, against the plant and Drake's own rotations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RollPitchYaw, RotationMatrix

from mala_drake.robot import plant_state as mut

angles = st.floats(-3.1, 3.1)
velocities = st.floats(-3.0, 3.0)


def _state(rotation, *, norm=1.0, velocity=(0.0, 0.0)):
    state = np.zeros(mut.PLANT_STATE_SIZE)
    state[: mut.X] = norm * rotation.ToQuaternion().wxyz()
    state[[mut.V_X, mut.V_Y]] = velocity
    return state.tolist()


def test_names_are_those_of_the_plant(make_bench):
    bench = make_bench()
    names = bench.plant.GetStateNames(bench.robot.robot, False)
    assert len(names) == mut.PLANT_STATE_SIZE
    for index, suffix in {
        mut.QW: "base_qw",
        mut.QZ: "base_qz",
        mut.X: "base_x",
        mut.LEFT_WHEEL_ANGLE: "left_wheel_spin_q",
        mut.OMEGA_Z: "base_wz",
        mut.V_X: "base_vx",
        mut.V_Y: "base_vy",
        mut.LEFT_WHEEL_SPEED: "left_wheel_spin_w",
        mut.RIGHT_WHEEL_SPEED: "right_wheel_spin_w",
    }.items():
        assert names[index].endswith(suffix)


@given(yaw=angles, tilt=st.floats(-0.3, 0.3), norm=st.floats(0.5, 2.0))
def test_yaw_is_the_heading_of_the_x_axis_for_a_quaternion_of_any_norm(yaw, tilt, norm):
    rotation = RotationMatrix(RollPitchYaw(tilt, -0.5 * tilt, yaw))
    forward = rotation.matrix()[:, 0]
    assert mut.yaw_of(_state(rotation, norm=norm)) == pytest.approx(math.atan2(forward[1], forward[0]))


@given(yaw=angles, v_x=velocities, v_y=velocities)
def test_velocities_are_turned_into_the_body_frame(yaw, v_x, v_y):
    rotation = RotationMatrix.MakeZRotation(yaw)
    v_W = rotation @ np.array([v_x, v_y, 0.0])
    planar = mut.planar_state_of(_state(rotation, velocity=v_W[:2]))
    assert planar == pytest.approx((0.0, 0.0, yaw, v_x, v_y, 0.0))
