import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.grounding import IN_TRANSIT, LocationGrounding, TruncatedAnnulus

WARD = {"stove": (-3.0, 20.5), "prep_station": (0.0, 20.0), "quality_check": (3.0, 21.0), "home": (0.0, 0.0)}
coordinates = st.floats(-25.0, 25.0)


def place_at(grounding, position, **options):
    return grounding.place(grounding.values(position), **options)


@given(coordinates, coordinates)
def test_the_place_is_the_nearest_one_within_two_point_two_metres(x, y):
    distances = {name: np.hypot(x - px, y - py) for name, (px, py) in WARD.items()}
    nearest = min(sorted(distances), key=distances.__getitem__)
    place = place_at(LocationGrounding(WARD), (x, y))
    if distances[nearest] < 2.2 - 1e-9:
        assert distances[place] == pytest.approx(distances[nearest]) or distances[place] <= 1.0
    elif distances[nearest] > 2.2 + 1e-9:
        assert place == IN_TRANSIT


def test_between_overlapping_places_the_nearer_one_holds():
    grounding = LocationGrounding(WARD)
    assert place_at(grounding, (-1.7, 20.3)) == "stove"
    assert place_at(grounding, (-1.2, 20.2)) == "prep_station"


def test_where_two_places_are_fully_true_the_expected_one_is_meant():
    close = LocationGrounding({"left": (0.0, 0.5), "right": (0.0, -0.5)})
    assert place_at(close, (0.0, 0.2), expected="right") == "right"
    assert place_at(close, (0.0, 0.2), expected="left") == "left"
    assert place_at(close, (0.0, 0.2)) == "left"  # The first name, wherever the robot came from.
    assert place_at(close, (0.0, 0.2), expected="elsewhere") == "left"


def test_expecting_a_place_does_not_make_it_true():
    assert place_at(LocationGrounding(WARD), (0.0, 1.0), expected="stove") == "home"
    assert place_at(LocationGrounding(WARD), (0.0, 5.0), expected="stove") == IN_TRANSIT


def test_the_order_in_which_places_are_given_does_not_matter():
    reversed_ward = dict(reversed(WARD.items()))
    assert LocationGrounding(WARD).places == LocationGrounding(reversed_ward).places == tuple(sorted(WARD))


def test_single_locations_agree_with_the_whole():
    grounding = LocationGrounding(WARD, membership=TruncatedAnnulus())
    position = (-1.0, 19.0)
    singly = [float(grounding.location(place).value(position)) for place in grounding.places]
    np.testing.assert_allclose(grounding.values(position), singly)


def test_a_position_that_is_not_a_number_is_nowhere():
    assert place_at(LocationGrounding(WARD), (np.nan, 0.0)) == IN_TRANSIT


def test_without_places_the_robot_is_always_in_transit():
    assert place_at(LocationGrounding({}), (0.0, 0.0)) == IN_TRANSIT


@pytest.mark.parametrize(
    ("locations", "threshold"),
    [({"": (0.0, 0.0)}, 0.7), ({"home": (0.0, float("inf"))}, 0.7), ({"home": (0.0, 0.0)}, 0.0)],
)
def test_bad_places_and_thresholds_are_refused(locations, threshold):
    with pytest.raises(BadInput):
        LocationGrounding(locations, threshold=threshold)
