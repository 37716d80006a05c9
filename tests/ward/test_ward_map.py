import itertools
import math
from collections import Counter

import pytest
import yaml

import mala_drake.ward.ward_map as mut
from mala_drake.errors import BadInput
from mala_drake.resources import models_folder
from mala_drake.ward.routes import BODY_RADIUS
from mala_drake.ward.shapes import ShapeDistances, outline

REFERENCE = {  # Where the case puts its places, metres; they may move by 1.5 m.
    "home": (0, 0),
    "pharmacy_north": (5, 18),
    "pharmacy_south": (6, -15),
    "supply_A": (14, 10),
    "supply_B": (15, -12),
    "charge_main": (3, 5),
    "charge_backup": (17, -18),
    "patient_bed_left": (20.5, 12),
    "patient_bed_right": (23.5, 10),
    "pantry": (-3, 15),
    "fridge": (-6, 17.5),
    "prep_station": (0, 20),
    "stove": (-3, 20.5),
    "quality_check": (3, 21),
}


@pytest.fixture(scope="module")
def ward():
    return mut.LoadWard()


@pytest.fixture
def data():
    return yaml.safe_load((models_folder() / "care_center.ward.yaml").read_text())


@pytest.fixture
def load(tmp_path):
    def load(data):
        path = tmp_path / "test.ward.yaml"
        path.write_text(data if isinstance(data, str) else yaml.safe_dump(data))
        return mut.LoadWard(path)

    return load


def test_the_hospital_has_its_places_near_where_the_case_puts_them(ward):
    assert set(ward.place) == set(REFERENCE)
    for name, point in REFERENCE.items():
        assert math.dist(point, (ward.place[name].x, ward.place[name].y)) <= 1.5


def test_the_hospital_has_places_of_all_categories(ward):
    counts = Counter(place.category for place in ward.places)
    assert counts == {"home": 1, "pharmacy": 2, "supply": 2, "charger": 2, "bedside": 2, "kitchen": 5}


def test_standing_points_keep_half_a_metre_from_everything_solid(ward):
    distances = ShapeDistances(ward.shapes)
    for place in ward.places:
        assert distances((place.x, place.y)).min() >= 0.5, place.name


def test_every_place_but_home_faces_what_it_serves(ward):
    for place in ward.places:
        if place.category == "home":
            continue
        piece = ward.furniture_of[place.name]
        reach = ShapeDistances([piece.shape])((place.x + math.cos(place.yaw), place.y + math.sin(place.yaw)))
        assert reach[0] <= 0.0, f"{place.name} does not look at {piece.name} within a metre"


def test_furniture_stands_inside_the_walls(ward):
    inner = ward.half_extent - ward.wall_half_thickness
    for piece in ward.furniture:
        assert max(abs(value) for value in outline(piece.shape).bounds) <= inner + 0.02, piece.name


def test_the_walls_close_the_ward(ward):
    outside = ward.half_extent + ward.wall_half_thickness
    assert ShapeDistances([wall.shape for wall in ward.walls])((0.0, 0.0)) == pytest.approx([24.8] * 4)
    corners = list(itertools.product((-outside + 0.01, outside - 0.01), repeat=2))
    inside_some_wall = ShapeDistances([wall.shape for wall in ward.walls])(corners) < ward.wall_half_thickness * 1.5
    assert inside_some_wall.any(axis=1).all()


def test_the_robot_fits_between_bed_and_walls(ward):
    for name in ("patient_bed_left", "patient_bed_right"):
        place = ward.place[name]
        assert ShapeDistances(ward.shapes)((place.x, place.y)).min() > BODY_RADIUS + 0.2


def test_a_map_survives_a_round_trip_through_another_file(ward, data, load):
    assert load(data) == ward
    assert hash(load(data)) == hash(ward)


def change(data, path, value):
    for key in path[:-1]:
        data = data[key]
    if value is ...:
        del data[path[-1]]
    else:
        data[path[-1]] = value


@pytest.mark.parametrize(
    ("path", "value", "told"),
    [
        (("places", 3, "yaw"), float("nan"), "places[3].yaw: nan; expected a finite number"),
        (("places", 3, "yaw"), "east", "places[3].yaw: 'east'; expected a finite number"),
        (("places", 3, "yaw"), True, "places[3].yaw: True"),
        (("places", 3, "yaw"), ..., "places[3]"),
        (("places", 3, "name"), 7, "places[3].name: 7; expected text"),
        (("places", 3, "colour"), "red", "places[3].colour: unknown key"),
        (("places", 3, "category"), "bar", "places[3].category: 'bar'; expected one of home"),
        (("places", 3, "x"), 30.0, "places[3]: (30.0, 10.0); expected a point inside the ward"),
        (("places", 3), "supply_A", "places[3]: 'supply_A'; expected a mapping"),
        (("places",), "home", "places: 'home'; expected a list"),
        (("places", 3, "name"), "home", "'home' appears 2 times"),
        (("furniture", 0, "serves"), "moon", "furniture[0].serves: 'moon'; expected the name of a place"),
        (("furniture", 0, "half_length"), -1.0, "furniture[0]: no positive size"),
        (("furniture", 0, "half_length"), 0.0, "furniture[0]: no positive size"),
        (("zones", 0, "level"), 1.0, "zones[0].level: 1.0; expected a level in (0, 1)"),
        (("zones", 0, "polygon"), [[0, 0], [1, 1]], "zones[0].polygon: 2 corners; expected at least 3"),
        (("zones", 0, "polygon"), [[0, 0], [1, 1], [0, float("inf")]], "expected at least 3 finite corners"),
        (("zones", 0, "polygon"), [[0, 0], [2, 2], [2, 0], [0, 2]], "zones[0].polygon: Self-intersection[1 1]"),
        (("zones", 0, "polygon"), [[0, 0], [1, 1], [2, 2]], "expected corners in order round an area"),
        (("zones", 0, "polygon"), "round", "zones[0].polygon: 'round'; expected a list of [x, y] corners"),
        (("zones", 0, "polygon"), 5, "zones[0].polygon: 5; expected a list of [x, y] corners"),
        (("background_congestion",), 0.0, "background_congestion: 0.0; expected a level in (0, 1)"),
        (("half_extent",), -25.0, "expected positive sizes"),
        (("half_extent",), ..., "half_extent"),
        (("colour",), "red", "colour: unknown key; expected one of name"),
    ],
)
def test_what_is_wrong_is_told_in_one_line(data, load, path, value, told):
    change(data, path, value)
    with pytest.raises(BadInput) as error:
        load(data)
    assert told in str(error.value)
    assert str(error.value).startswith("test.ward.yaml")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("text", ["", "- 1\n- 2\n", "text", "a: [1, 2", "{unclosed", "a: *nobody", "name: 2024-13-45"])
def test_a_file_that_is_no_map_is_refused_in_one_line(load, text):
    with pytest.raises(BadInput) as error:
        load(text)
    assert "test.ward.yaml" in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_that_cannot_be_read_is_refused(tmp_path):
    binary = tmp_path / "binary.ward.yaml"
    binary.write_bytes(bytes(range(128, 256)))
    for path in (tmp_path / "missing.yaml", tmp_path, binary):
        with pytest.raises(BadInput, match="cannot be read"):
            mut.LoadWard(path)
