"""Scenarios that cannot be simulated: every field of one is named in one line."""

from __future__ import annotations

import math
from dataclasses import fields, is_dataclass

import numpy as np
import pytest
import yaml

from mala_drake.errors import BadInput
from mala_drake.resources import models_folder
from mala_drake.scenario import Scenario
from mala_drake.scenario import validation as mut
from mala_drake.ward.routes import BODY_RADIUS
from mala_drake.ward.shapes import ShapeDistances


@pytest.fixture
def refusal(load_scenario):
    """A callable that tells, in one line, why a scenario with this text is refused."""

    def line(text):
        with pytest.raises(BadInput) as caught:
            load_scenario(text)
        assert "\n" not in str(caught.value)
        return str(caught.value)

    return line


def numbers_of(value, prefix=""):
    """Every float field of a scenario, as (its owner, its name, its dotted name)."""
    for item in fields(value):
        entry = getattr(value, item.name)
        if is_dataclass(entry):
            yield from numbers_of(entry, f"{prefix}{item.name}.")
        elif isinstance(entry, float):
            yield prefix, item.name


def set_number(scenario, prefix, name, number):
    for part in prefix.split(".")[:-1]:
        scenario = getattr(scenario, part)
    setattr(scenario, name, number)


NUMBERS = sorted(numbers_of(Scenario()))


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize(("prefix", "name"), NUMBERS)
def test_no_number_may_be_infinite_or_undefined(prefix, name, number):
    scenario = Scenario()
    set_number(scenario, prefix, name, number)
    with pytest.raises(BadInput, match=rf"here: {prefix}{name}: -?(nan|inf); expected a finite number"):
        mut.Validate(scenario, where="here")


@pytest.mark.parametrize(("prefix", "name"), NUMBERS)
def test_no_number_may_be_negative(prefix, name):
    scenario = Scenario()
    set_number(scenario, prefix, name, -0.5)
    with pytest.raises(BadInput, match=rf"here: {prefix}{name}: -0\.5; expected"):
        mut.Validate(scenario, where="here")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("episodes: 0", ["episodes: 0", "from 1 to 1000000"]),
        ("episodes: 2.5", ["episodes: 2.5", "a whole number"]),
        ("random_seed: -1", ["random_seed: -1", ">= 0"]),
        ("task: dance", ["task: 'dance'", "medication"]),
        ("patient: {profile: nobody}", ["patient.profile: 'nobody'", "speed_oriented", "safety_first"]),
        ("control: {solver: guess}", ["control.solver: 'guess'", "snopt", "ipopt"]),
        ("control: {sqp_iterations: 0}", ["control.sqp_iterations: 0", "from 1"]),
        ("control: {horizon_kind: growing}", ["control.horizon_kind: 'growing'", "receding, shrinking"]),
        ("control: {translation_rate: 0.0}", ["control.translation_rate: 0", "from 1e-09 to 1"]),
        ("control: {horizon: 1}", ["control.horizon: 1", "from 2"]),
        ("control: {tolerance: 0.5}", ["control.tolerance: 0.5", "from 1e-10 to 0.1"]),
        ("control: {tolerance: 0}", ["control.tolerance: 0", "from 1e-10 to 0.1"]),
        ("control: {qp_solver: guess}", ["control.qp_solver: 'guess'", "daqp, clarabel, osqp"]),
        ("control: {hard_clearance: 0.1}", ["control.hard_clearance: 0.1", "true or false"]),
        (
            "control: {hard_clearance: true, learned_targets: true}",
            ["control.hard_clearance: true, with learned_targets", "expected false"],
        ),
        (
            "control: {hard_clearance: true, learned_translation: true}",
            ["control.hard_clearance: true, with learned_translation", "expected false"],
        ),
        ("learner: {name: oracle}", ["learner.name: 'oracle'", "projected_gradient", "fixed"]),
        ("grounding: {membership: vague}", ["grounding.membership: 'vague'", "fuzzy, crisp"]),
        ("world: {risk_variation: 1.5}", ["world.risk_variation: 1.5", "from 0 to 1"]),
        ("patient: {earlier_weights: [1, 1, 0, 0, 0], earlier_episodes: 3}", ["patient.earlier_weights", "expected 1"]),
        ("patient: {earlier_episodes: -1}", ["patient.earlier_episodes: -1", ">= 0"]),
        ("patient: {earlier_episodes: 3}", ["patient.earlier_weights: none", "weights of those"]),
        ("learner: {random_initial_weights: true}", ["learner.initial_weights: given to posterior"]),
        (
            "learner: {name: fixed, random_initial_weights: true, initial_weights: [1, 0, 0, 0, 0]}",
            ["learner.initial_weights", "one or the other"],
        ),
        ("robot: {initial_charge: 1.5}", ["robot.initial_charge: 1.5", "from 0 to 1"]),
        ("world: {wrong_item_probability: 2}", ["world.wrong_item_probability: 2", "from 0 to 1"]),
        ("world: {wrong_items: [candy]}", ["world.wrong_items[0]: 'candy'", "med_antibiotic"]),
        ("patient: {true_weights: [0.5, 0.5]}", ["patient.true_weights: 2 weights", "5"]),
        ("patient: {true_weights: [0.5, 0.5, 0.5, 0, 0]}", ["patient.true_weights", "1.5", "expected 1"]),
        ("patient: {true_weights: [1.5, -0.5, 0, 0, 0]}", ["patient.true_weights.safety", "-0.5"]),
        ("patient: {true_weights: [.nan, 1, 0, 0, 0]}", ["patient.true_weights[0]: nan", "finite"]),
        ("learner: {initial_weights: [1, 1, 0, 0, 0]}", ["learner.initial_weights", "sum", "2"]),
        ("world: {obstacles: [{x: .inf}]}", ["world.obstacles[0].x: inf", "finite"]),
        ("world: {obstacles: [{x: 0.3, y: 0.1}]}", ["world.obstacles[0]", "robot at home"]),
        ("world: {obstacles: [{x: 5, height: 0}]}", ["world.obstacles[0]", "above 0"]),
        ("world: {obstacles: [{x: 5000}]}", ["world.obstacles[0].x: 5000", "from -25 to 25"]),
        ("world: {obstacles: [{x: 5, y: -1e300}]}", ["world.obstacles[0].y: -1e+300", "from -25 to 25"]),
        (
            "world: {obstacles: [{x: 5, half_length: 1e300}]}",
            ["obstacles[0].half_length: 1e+300", "from 0 to 25"],
        ),
        ("world: {obstacles: [{x: 5, half_width: 26}]}", ["world.obstacles[0].half_width: 26", "from 0 to 25"]),
        ("world: {obstacles: [{x: 5, height: 26}]}", ["world.obstacles[0].height: 26", "from 0 to 25"]),
        ("world: {obstacles: [{x: 5}, {x: 9}]}", ["world.obstacles[1].name: 'trolley'", "no other obstacle"]),
        ("world: {displaced_places: [{place: attic, dx: 2}]}", ["world.displaced_places[0].place: 'attic'", "pantry"]),
        ("world: {displaced_places: [{place: home, dx: 2}]}", ["world.displaced_places[0].place: 'home'"]),
        (
            "world: {displaced_places: [{place: pantry, dy: 2}, {place: pantry, dy: -2}]}",
            ["world.displaced_places[1].place: 'pantry' again", "each place once"],
        ),
        ("world: {randomly_displaced: [attic]}", ["world.randomly_displaced[0]: 'attic'", "pantry"]),
        (
            "world: {displaced_places: [{place: pantry, dy: 2}], randomly_displaced: [pantry]}",
            ["world.randomly_displaced[0]: 'pantry' again"],
        ),
        ("world: {displaced_places: [{place: pantry, dx: .nan}]}", ["displaced_places[0].dx: nan", "finite"]),
        (  # The shelf would stand where the map says that the robot is to stand.
            "world: {displaced_places: [{place: pantry, dx: -1.5}]}",
            ["world.displaced_places: pantry at (-3.00, 15.00)", "taken by pantry_shelf"],
        ),
        (  # Where the map says that the shelf is, the robot does not go.
            "world: {displaced_places: [{place: pantry, dx: 1.5}]}",
            ["world.displaced_places: pantry at (-1.50, 15.00)", "taken by pantry_shelf"],
        ),
        (  # The cabinet would stand where the robot stands at another place.
            "world: {displaced_places: [{place: pharmacy_north, dx: -2, dy: 1.7}]}",
            ["world.displaced_places: quality_check", "taken by pharmacy_north_cabinet"],
        ),
        ("world: {displaced_places: [{place: supply_A, dx: 40}]}", ["world.displaced_places: supply_A at (54.00"]),
        ("control: {target_evidence: hearsay}", ["control.target_evidence: 'hearsay'", "fuzzy, geometric"]),
        ("control: {target_sensitivity: none}", ["control.target_sensitivity: 'none'", "simulated, identity"]),
        ("ward: nowhere.ward.yaml", ["ward", "nowhere.ward.yaml", "path of a ward map"]),
        ('ward: "a\\0b"', ["ward: ", "path of a ward map"]),
        (f"ward: {'a' * 5000}", ["ward: ", "path of a ward map"]),
        ("robto: {}", ["robto: unknown key", "robot"]),
    ],
)
def test_a_mistake_in_the_file_is_named(refusal, text, words):
    line = refusal(text)
    assert line.startswith("mine.scenario.yaml: ")
    for word in words:
        assert word in line


def test_a_number_of_hundreds_of_digits_is_refused_like_any_other():
    with pytest.raises(BadInput, match="episodes: a number of hundreds of digits; expected a number from 1 to 1000000"):
        mut.Validate(Scenario(episodes=10**400))


def test_targets_may_be_learned_with_hard_clearance_where_no_leg_is_simulated(load_scenario):
    load_scenario("control: {hard_clearance: true, learned_targets: true, target_sensitivity: identity}")


@pytest.fixture(scope="module")
def plain_map():
    return (models_folder() / "care_center.ward.yaml").read_text(encoding="utf-8")


def with_map(tmp_path, text):
    """The text of a scenario in the ward of that map."""
    (tmp_path / "mine.ward.yaml").write_text(text, encoding="utf-8")
    return "ward: mine.ward.yaml"


def changed(text, change):
    ward = yaml.safe_load(text)
    change(ward)
    return yaml.safe_dump(ward)


def move(name, x, y):
    def change(ward):
        place = next(place for place in ward["places"] if place["name"] == name)
        place.update(x=x, y=y)

    return change


@pytest.mark.parametrize(
    ("name", "x", "y", "solid"),
    [
        ("pharmacy_north", 5.0, 19.3, "pharmacy_north_cabinet"),  # Where its own cabinet stands.
        ("patient_bed_left", 21.0, 9.0, "bed"),
        ("pantry", -1.0, 12.2, "kitchen_wall_middle"),
        ("fridge", -24.7, 17.0, "wall_west"),
        ("charge_main", 24.9, 24.9, "wall_"),
    ],
)
def test_a_place_where_the_robot_does_not_fit_is_refused(tmp_path, refusal, plain_map, name, x, y, solid):
    line = refusal(with_map(tmp_path, changed(plain_map, move(name, x, y))))
    for word in ("mine.ward.yaml: places[", name, solid, str(BODY_RADIUS)):
        assert word in line


def test_a_place_may_be_as_near_to_furniture_as_the_robot_is_wide(tmp_path, load_scenario, refusal, plain_map):
    east_face_of_fridge = -7.1 + 0.5
    near = changed(plain_map, move("fridge", east_face_of_fridge + BODY_RADIUS + 0.01, 17.5))
    load_scenario(with_map(tmp_path, near))
    too_near = changed(plain_map, move("fridge", east_face_of_fridge + BODY_RADIUS - 0.01, 17.5))
    assert "fridge_body is 0.27 m" in refusal(with_map(tmp_path, too_near))


def test_the_ward_that_comes_with_the_package_leaves_half_a_metre_everywhere():
    ward = Scenario().load_ward()
    distances = ShapeDistances(ward.shapes)
    assert np.min(distances([[place.x, place.y] for place in ward.places])) >= 0.5


def no_home(ward):
    ward["places"][0]["category"] = "kitchen"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (no_home, ["places", "home"]),
        (lambda ward: ward["places"][2].update(x=math.nan), ["places[2].x", "nan", "finite"]),
        (lambda ward: ward["places"][2].update(x="east"), ["places[2].x", "east"]),
        (lambda ward: ward["places"][2].pop("y"), ["places[2]", "y"]),
        (lambda ward: ward["places"][2].update(x=99.0), ["places[2]", "inside the ward"]),
        (lambda ward: ward["places"][2].update(category="cellar"), ["places[2].category", "cellar"]),
        (lambda ward: ward["places"].append(ward["places"][0]), ["home", "2 times", "unique"]),
        (lambda ward: ward["furniture"][0].update(model="piano"), ["model", "piano"]),
        (lambda ward: ward["furniture"][0].update(height=-1.0), ["height", "-1"]),
        (lambda ward: ward["furniture"][0].update(serves="cellar"), ["furniture[0].serves", "cellar"]),
        (lambda ward: ward["zones"][0].update(level=1.5), ["zones[0].level", "1.5"]),
        (lambda ward: ward["zones"][0].update(polygon=[[0, 0]]), ["zones[0].polygon", "3"]),
        (lambda ward: ward.pop("half_extent"), ["half_extent"]),
        (lambda ward: ward.update(half_extent=-1.0), ["half_extent", "positive"]),
        (lambda ward: ward.update(places={}), ["places", "a list"]),
        (lambda ward: ward.update(doors=[]), ["doors", "unknown key"]),
    ],
)
def test_a_mistake_in_the_map_is_named(tmp_path, refusal, plain_map, change, words):
    line = refusal(with_map(tmp_path, changed(plain_map, change)))
    for word in words:
        assert word in line


@pytest.mark.parametrize("text", ["{{{", "- a\n- b\n", "", "places: 3", "\x00"])
def test_what_is_no_map_is_refused(tmp_path, refusal, text):
    assert "mine.ward.yaml" in refusal(with_map(tmp_path, text))
