"""The compiled magnets of the pads, against the laws it is made of, evaluated on floats."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.robot import held_boxes as mut
from mala_drake.robot.arm_kinematics import PAD_RADIUS
from mala_drake.robot.gripper_motion import gripper_motion
from mala_drake.robot.magnet_law import GRAVITY, MagnetLaw, Place
from mala_drake.ward.items import ITEM_HALF_HEIGHT

LAW = MagnetLaw()
BASE = [0.9, 0.02, -0.01, 0.45, 3.0, -2.0, 0.01, 0.1, -0.05, 0.6, 1.1, 0.3, 0.02]
ANGLES, RATES = [0.4, 1.2, -1.5], [0.5, -0.3, 0.2]
small = st.floats(-0.06, 0.06)


@pytest.fixture(scope="module")
def duts():
    return [mut.boxes_at_pads(LAW, [pad]) for pad in (0, 1)]


@pytest.fixture(scope="module")
def both():
    return mut.boxes_at_pads(LAW, [0, 1])


def _evaluate(dut, *boxes):
    dut.arguments[0][:, 0] = [*BASE, *(value for box in boxes for value in box), *ANGLES, *RATES]
    dut()
    return dut.results[0][:, 0].copy()


def _box_near(pad, offset, turn=0.0):
    """A box `offset` metres from where it hangs, its quaternion not normalised."""
    middle = gripper_motion(BASE, ANGLES, RATES).pad_position(pad)
    position = np.array(middle) - [0.0, 0.0, PAD_RADIUS + ITEM_HALF_HEIGHT] + offset
    return [1.1, 0.05, -0.02, turn, *position, 0.2, 0.1, -0.3, 1.0, 0.4, -0.1]


@pytest.mark.parametrize("pad", [0, 1])
@given(offset=st.tuples(small, small, small), turn=st.floats(-2.0, 2.0))
def test_it_is_wrench_and_reaction_of_the_laws(duts, pad, offset, turn):
    box = _box_near(pad, offset, turn)
    motion = gripper_motion(BASE, ANGLES, RATES)
    middle = motion.pad_position(pad)
    hanging = (middle[0], middle[1], middle[2] - PAD_RADIUS - ITEM_HALF_HEIGHT)
    torque, force = LAW.wrench(box, Place(hanging, motion.yaw, motion.velocity_at(middle), motion.yaw_rate))
    opposite = (tuple(-value for value in torque), tuple(-value for value in force))
    on_base, on_joints = motion.generalized_force(tuple(box[4:7]), *opposite)
    assert _evaluate(duts[pad], box) == pytest.approx([*on_base, *torque, *force, *on_joints], abs=1e-9)


@given(offsets=st.lists(st.tuples(small, small, small), min_size=2, max_size=2), turn=st.floats(-2.0, 2.0))
def test_the_robot_feels_two_boxes_as_the_sum_of_each_to_the_last_bit(duts, both, offsets, turn):
    boxes = [_box_near(pad, offset, turn) for pad, offset in enumerate(offsets)]
    first, second = (_evaluate(dut, box) for dut, box in zip(duts, boxes, strict=True))
    together = _evaluate(both, *boxes)
    assert together[:6].tolist() == (first[:6] + second[:6]).tolist()
    assert together[6:18].tolist() == [*first[6:12], *second[6:12]]
    assert together[18:].tolist() == (first[12:] + second[12:]).tolist()


@pytest.mark.parametrize("pad", [0, 1])
def test_force_and_reaction_cancel(duts, pad):
    result = _evaluate(duts[pad], _box_near(pad, (0.01, 0.0, -0.01)))
    assert result[3:6] == pytest.approx(-result[9:12])
    assert np.linalg.norm(result[9:12]) > 0.2 * GRAVITY


@pytest.mark.parametrize("position", [(0.0, 0.0, 0.0), (np.nan, 0.0, 0.0), (np.inf, 0.0, 0.0)])
def test_a_box_that_is_not_there_is_not_pulled(duts, position):
    box = [1.0, 0.0, 0.0, 0.0, *position, *[0.0] * 6]
    assert np.array_equal(_evaluate(duts[0], box)[6:12], np.zeros(6))
