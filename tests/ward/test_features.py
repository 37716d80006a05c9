import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mala_drake.ward.features as mut
from mala_drake.ward.congestion import RISK_LENGTH, Congestion, sample
from mala_drake.ward.ward_map import Furniture, Ward

poses = st.tuples(st.floats(-25, 25), st.floats(-25, 25), st.floats(-7, 7))


@pytest.fixture(scope="module")
def rates(ward):
    return mut.FeatureRates(ward)


def test_risk_per_second_is_level_times_speed(ward, rates):
    points = np.array([[-3.0, 15.0], [20.0, -20.0]])
    levels = Congestion(ward).level(points)
    assert rates.risk_rate(points, [1.5, 0.5]) == pytest.approx(levels * [1.5, 0.5] / RISK_LENGTH)


@pytest.mark.parametrize("speed", [0.3, 1.5])
def test_the_risk_of_a_path_does_not_depend_on_the_speed(ward, rates, speed):
    path = np.array([[0.0, 0.0], [5.0, 18.0], [14.0, 10.0]])
    middles, lengths = sample(path)
    collected = rates.risk_rate(middles, np.full(len(lengths), speed)) @ (lengths / speed)
    assert collected == pytest.approx(Congestion(ward).risk(path))


def test_driving_backward_is_no_negative_risk_or_discomfort(rates):
    point = np.array([20.5, 12.0])
    assert rates.risk_rate(point, -0.4) == pytest.approx(rates.risk_rate(point, 0.4))
    assert rates.discomfort_rate(point, -0.4) == pytest.approx(rates.discomfort_rate(point, 0.4))


def test_discomfort_fades_with_the_distance_from_the_bed():
    bed = Furniture("bed", "bed", 0.0, 0.0, 1.0, half_length=1.0, half_width=2.0)
    rates = mut.FeatureRates(Ward("test", 20.0, 0.2, 2.0, (), (bed,), (), 0.02))
    standing = rates.discomfort_rate([[1.0, 0.0], [2.5, 0.0], [4.0, 0.0], [9.0, 0.0]], 0.0)
    assert standing == pytest.approx(standing[0] * np.array([1.0, 0.5, 0.0, 0.0]))
    assert standing[0] > 0
    moving = rates.discomfort_rate([2.5, 0.0], 1.0)
    assert moving - standing[1] == pytest.approx(0.5)


def test_without_a_patient_nobody_is_discomforted():
    rates = mut.FeatureRates(Ward("test", 20.0, 0.2, 2.0, (), (), (), 0.02))
    assert rates.discomfort_rate(np.zeros((3, 2)), np.ones(3)) == pytest.approx(np.zeros(3))


@given(pose=poses, ideal=poses)
def test_approach_errors_lie_between_zero_and_one(pose, ideal):
    assert 0.0 <= mut.approach_error(pose, ideal) <= 1.0
    assert mut.approach_error(pose, pose) == 0.0
    whole_turn = (pose[0], pose[1], pose[2] + math.tau)
    assert mut.approach_error(whole_turn, ideal) == pytest.approx(mut.approach_error(pose, ideal), abs=1e-9)


def test_half_a_turn_and_four_metres_are_the_worst():
    ideal = (1.0, 2.0, 0.3)
    assert mut.approach_error((1.0, 2.0, 0.3 + math.pi), ideal) == pytest.approx(0.5)
    assert mut.approach_error((5.0, 2.0, 0.3), ideal) == pytest.approx(0.5)
    assert mut.approach_error((3.0, 2.0, 0.3), ideal) == pytest.approx(0.25)
    assert mut.approach_error((40.0, 2.0, 0.3 + math.pi), ideal) == pytest.approx(1.0)


def test_scales_are_in_the_order_of_the_features():
    scales = mut.FeatureScales(time=1.0, safety=2.0, battery=3.0, proximity=4.0, approach=5.0)
    assert scales.as_array() == pytest.approx([getattr(scales, name) for name in mut.FEATURES])


def test_the_right_bedside_is_the_better_approach(ward):
    def error(name):
        place = ward.place[name]
        return mut.approach_error((place.x, place.y, place.yaw), mut.IDEAL_HAND_OVER)

    assert error("patient_bed_right") < error("patient_bed_left")


def test_a_task_that_hands_nothing_over_has_the_worst_approach():
    assert mut.worst_approach_error("medication") == 1.0
    assert all(mut.worst_approach_error("meal") >= 1.0 + dish.presentation_error for dish in mut.DISHES.values())
