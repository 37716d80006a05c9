import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mala_drake.ward.congestion as mut
from mala_drake.ward.ward_map import LoadWard, Ward, Zone

BACKGROUND = 0.02


def square(name, level, low, high):
    return Zone(name, level, ((low, low), (high, low), (high, high), (low, high)))


@pytest.fixture(scope="module")
def congestion():
    zones = (square("busy", 0.4, 2.0, 6.0), square("calm", 0.1, 0.0, 8.0), square("idle", 0.01, 10.0, 12.0))
    ward = Ward("test", 20.0, 0.2, 2.0, (), (), zones, BACKGROUND)
    return mut.Congestion(ward)


def test_the_highest_level_counts(congestion):
    assert congestion.level([[4, 4], [1, 1], [-3, -3]]) == pytest.approx([0.4, 0.1, BACKGROUND])


def test_no_zone_is_calmer_than_the_background(congestion):
    assert congestion.level([11, 11]) == pytest.approx(BACKGROUND)


def test_levels_keep_the_shape_of_the_points(congestion):
    assert congestion.level(np.zeros((2, 3, 2))).shape == (2, 3)


def test_congestion_slows_down(congestion):
    assert congestion.speed_limit([[4, 4], [-3, -3]]) == pytest.approx([1.5 / 1.4, 1.5 / 1.02])


def test_the_risk_of_a_straight_path_is_level_times_length_of_each_piece(congestion):
    # From x = -2 to 10 at y = 4: 2 m outside, 2 m calm, 4 m busy, 2 m calm, 2 m outside.
    expected = (4 * BACKGROUND + 4 * 0.1 + 4 * 0.4) / mut.RISK_LENGTH
    assert congestion.risk([[-2, 4], [10, 4]]) == pytest.approx(expected, rel=1e-9)


@settings(max_examples=30)
@given(corners=st.lists(st.tuples(st.floats(-5, 15), st.floats(-5, 15)), min_size=3, max_size=5))
def test_risk_adds_up_along_a_path(congestion, corners):
    corners, risk = np.array(corners), congestion.risk
    assert risk(corners) == pytest.approx(risk(corners[:2]) + risk(corners[1:]), abs=1e-9)
    # The samples of the way back are the same up to rounding, which matters on a zone's border only.
    assert risk(corners[::-1]) == pytest.approx(risk(corners), rel=0.02, abs=0.01)


@given(corners=st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), min_size=2, max_size=5))
def test_samples_cover_the_whole_path(corners):
    corners = np.array(corners)
    middles, lengths = mut.sample(corners)
    assert lengths.sum() == pytest.approx(np.hypot(*np.diff(corners, axis=0).T).sum())
    assert len(middles) == len(lengths)
    assert lengths.max() <= 0.05 + 1e-9


def test_standing_still_is_no_risk(congestion):
    assert congestion.risk([[4, 4], [4, 4]]) == 0.0
    assert congestion.risk([[4, 4]]) == 0.0


def test_the_hospital_ward_is_riskier_at_the_stove_and_at_the_left_bedside():
    ward = LoadWard()
    hospital = mut.Congestion(ward)
    level = {place.name: hospital.level((place.x, place.y)) for place in ward.places}
    assert level["stove"] > level["pantry"] > hospital.level((-20.0, -20.0))
    assert level["patient_bed_left"] > level["patient_bed_right"]
