"""The generated models against the map, and the meshes and signs against plane geometry."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.resources import models_folder
from mala_drake.ward import models as mut
from mala_drake.ward.furnishing.flat import lettering, obj_text
from mala_drake.ward.furnishing.floor import floor_regions, floor_tiles
from mala_drake.ward.furnishing.signs import sign_heights, sign_lines
from mala_drake.ward.ward_map import Furniture, Zone


def triangles_of(text: str) -> np.ndarray:
    """The triangles of an OBJ text, shape (n, 3, 2), read without the code under test."""
    vertices = [[float(x) for x in line.split()[1:3]] for line in text.splitlines() if line.startswith("v ")]
    faces = [re.findall(r"(\d+)//", line) for line in text.splitlines() if line.startswith("f ")]
    return np.array([[vertices[int(i) - 1] for i in face] for face in faces])


def region_of(text: str) -> shapely.Geometry:
    return shapely.union_all([shapely.Polygon(triangle) for triangle in triangles_of(text)])


def test_committed_files_are_what_the_map_gives(ward):
    folder = models_folder() / mut.PACKAGE_FOLDER
    files = mut.ward_files(ward)
    assert {path.name for path in folder.iterdir()} == set(files), "run scripts/make_ward_models.py"
    for name, write in files.items():
        committed, expected = (folder / name).read_text(encoding="utf-8"), write()
        if name.endswith(".obj"):  # Another triangulation, or another release of the font, is the same picture.
            shown, wanted = region_of(committed), region_of(expected)
            assert shapely.symmetric_difference(shown, wanted).area <= 2e-3 * wanted.area, name
        else:
            assert committed == expected, f"{name}: run scripts/make_ward_models.py"
    directives = (models_folder() / "care_center.dmd.yaml").read_text(encoding="utf-8")
    assert directives == mut.ward_directives(ward), "run scripts/make_ward_models.py"


def test_directives_weld_every_piece_of_the_map_where_the_map_has_it(ward):
    class Reader(yaml.SafeLoader):
        pass

    Reader.add_constructor("!Rpy", lambda loader, node: loader.construct_mapping(node, deep=True))
    welds = {}
    for directive in yaml.load(mut.ward_directives(ward), Reader)["directives"]:
        if weld := directive.get("add_weld"):
            assert weld["parent"] == "world"
            welds[weld["child"].removesuffix("::base")] = weld.get("X_PC")
    for piece in (*ward.furniture, *ward.walls):
        X_PC = welds[piece.name]
        np.testing.assert_allclose(X_PC["translation"], [piece.x, piece.y, 0.0], atol=1e-6)
        np.testing.assert_allclose(np.radians(X_PC["rotation"]["deg"]), [0.0, 0.0, piece.yaw], atol=1e-6)
    assert {f"sign_{place.name}" for place in ward.places} <= set(welds)


def test_a_file_name_tells_the_content(ward):
    """Two pieces of furniture share a file only if model and sizes are equal, so a changed size is a new file."""
    bed = next(piece for piece in ward.furniture if piece.model == "bed")
    longer = replace(bed, name="longer", half_width=bed.half_width + 0.1)
    files = mut.ward_files(replace(ward, furniture=(*ward.furniture, longer)))
    assert len([name for name in files if name.startswith("bed_")]) == 2
    moved = replace(ward, furniture=(*ward.furniture, replace(bed, name="moved", x=0.0)))
    assert set(mut.ward_files(moved)) == set(mut.ward_files(ward))


@pytest.mark.parametrize(
    ("piece", "told"),
    [
        (Furniture("thing", "sofa", 0, 0, 1, half_length=1, half_width=1), "'sofa'"),
        (Furniture("thing", "planter", 0, 0, 1, half_length=1, half_width=1), "radius"),
        (Furniture("thing", "bed", 0, 0, 1, radius=1), "half_length"),
        (Furniture("thing", "bed", 0, 0, 0, half_length=1, half_width=1), "height"),
        (Furniture("thing", "fridge", 0, 0, 0.7, half_length=1, half_width=1), "no room for its"),
        (Furniture("a: b", "bed", 0, 0, 1, half_length=1, half_width=1), "'a: b'"),
        (Furniture("../bed", "bed", 0, 0, 1, half_length=1, half_width=1), "'../bed'"),
        (Furniture("floor", "bed", 0, 0, 1, half_length=1, half_width=1), "'floor'"),
        (Furniture("wall_north", "bed", 0, 0, 1, half_length=1, half_width=1), "'wall_north'"),
    ],
)
def test_furniture_that_cannot_be_built_is_refused_in_one_line(ward, piece, told):
    with pytest.raises(BadInput) as caught:
        mut.ward_models(replace(ward, furniture=(*ward.furniture, piece)))
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_signs_read_like_the_places():
    assert sign_lines("home") == ("Home",)
    assert sign_lines("supply_A") == ("Supply A",)
    assert sign_lines("pharmacy_north") == ("Pharmacy", "north")
    assert sign_lines("patient_bed_left") == ("Patient", "bed left")


def test_letters_have_their_holes_and_are_centered():
    letters = lettering(("oB", "i"), size=1.0)
    assert sorted(len(letter.interiors) for letter in letters.geoms) == [0, 0, 1, 2]  # The i is two pieces.
    left, bottom, right, top = letters.bounds
    assert left == pytest.approx(-right, abs=0.02)
    assert (bottom + top) / 2 == pytest.approx(0.0, abs=0.15)


coordinates = st.floats(-24.0, 24.0)
corners = st.tuples(coordinates, coordinates, st.floats(0.5, 20.0), st.floats(0.5, 20.0))


@st.composite
def zones(draw) -> list[Zone]:
    found = []
    for i, (x, y, width, height) in enumerate(draw(st.lists(corners, min_size=1, max_size=5))):
        polygon = ((x, y), (x + width, y), (x + width / 2, y + height))
        found.append(Zone(f"zone_{i}", draw(st.sampled_from((0.1, 0.2, 0.4))), polygon))
    return found


@settings(max_examples=40, deadline=None)
@given(zones(), st.lists(st.tuples(coordinates, coordinates), min_size=5, max_size=5))
def test_floor_shows_the_highest_congestion_level_at_every_point(zones, points):
    regions = floor_regions(25.0, zones)
    assert sum(region.area for _, region in regions) == pytest.approx(2500.0, rel=1e-9)
    for point in map(shapely.Point, points):
        inside = [zone.level for zone in zones if shapely.Polygon(zone.polygon).contains(point)]
        on_edge = any(shapely.Polygon(zone.polygon).exterior.distance(point) < 1e-6 for zone in zones)
        assume(not on_edge)
        (shown,) = [level for level, region in regions if region.contains(point)]
        assert shown == max(inside, default=0.0)


@settings(max_examples=40, deadline=None)
@given(st.lists(corners, min_size=1, max_size=3), corners)
def test_meshes_cover_their_region_once_and_face_up(outers, hole):
    boxes = [shapely.box(x, y, x + width, y + height) for x, y, width, height in outers]
    x, y, width, height = hole
    region = shapely.union_all(boxes).difference(shapely.Point(x, y).buffer(min(width, height) / 4))
    assume(region.area > 0.1)
    triangles = triangles_of(obj_text(region))
    one, two = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    areas = (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / 2
    assert np.all(areas >= -1e-3)  # Rounding to 0.1 mm may turn a sliver over.
    assert areas.sum() == pytest.approx(region.area, rel=1e-3, abs=1e-2)


def test_tiles_are_a_checkerboard_of_the_region():
    region = shapely.box(-5.0, -5.0, 5.0, 5.0)
    light, dark = floor_tiles(region)
    assert shapely.union(light, dark).equals(region)
    assert light.area == pytest.approx(dark.area)
    assert dark.contains(shapely.Point(1.0, -1.0)) != dark.contains(shapely.Point(1.0, 1.0))


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(coordinates, coordinates), min_size=2, max_size=10))
def test_no_sign_hides_another_seen_from_the_south(positions):
    named = {f"place_{i}": position for i, position in enumerate(positions)}
    heights = sign_heights(named)
    # A panel with one line of seven letters is more than 2 m wide and 0.65 m high; it is tilted by 45 degrees.
    for one, two in combinations(named, 2):
        across = abs(named[one][0] - named[two][0])
        up = abs((named[one][1] + heights[one]) - (named[two][1] + heights[two])) / np.sqrt(2)
        assert across > 2.0 or up > 0.65
