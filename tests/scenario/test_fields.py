"""Scenarios: what the fields of one say together."""

from __future__ import annotations

import inspect

import pytest

from mala_drake.control import SOLVER_NAMES, MakeSolver, OptimalControlProblem
from mala_drake.patient.profiles import PROFILES
from mala_drake.scenario import fields as mut


@pytest.fixture(scope="module")
def problem():
    return OptimalControlProblem(horizon=2)


def test_true_weights_replace_the_profile(load_scenario):
    scenario = load_scenario("patient: {true_weights: [0.2, 0.2, 0.2, 0.2, 0.2]}")
    assert scenario.true_weights == (0.2,) * 5
    assert scenario.profile_name == "custom"


def test_a_change_of_mind_gives_the_first_episodes_other_weights(load_scenario):
    text = "patient: {profile: safety_first, earlier_weights: [0.2, 0.2, 0.2, 0.2, 0.2], earlier_episodes: 2}"
    scenario = load_scenario(text)
    assert [scenario.true_weights_in(episode) for episode in range(4)] == [
        (0.2,) * 5,
        (0.2,) * 5,
        PROFILES["safety_first"],
        PROFILES["safety_first"],
    ]
    assert mut.Scenario().true_weights_in(0) == mut.Scenario().true_weights


def test_initial_weights_may_be_drawn_by_the_seed(load_scenario):
    text = "{random_seed: %d, learner: {name: projected_gradient, random_initial_weights: true}}"
    drawn = [tuple(load_scenario(text % seed).settled_learner.initial_weights) for seed in (0, 1, 0)]
    assert drawn[0] == drawn[2] != drawn[1]
    assert all(sum(weights) == pytest.approx(1.0) and min(weights) >= 0.0 for weights in drawn)
    untouched = mut.Scenario()
    assert untouched.settled_learner == untouched.learner


@pytest.mark.parametrize("name", SOLVER_NAMES)
def test_the_controllers_solver_is_by_default_as_its_class_makes_it(problem, name):
    options = mut.ControlConfig(solver=name).solver_options
    defaults = inspect.signature(type(MakeSolver(name, problem, **options))).parameters
    assert options == {option: defaults[option].default for option in options}


def test_the_options_of_the_controllers_solver_are_the_files(load_scenario):
    text = "control: {sqp_iterations: 3, qp_solver: clarabel, tolerance: 0.001, hard_clearance: true}"
    own = {"sqp_iterations": 3, "qp_solver": "clarabel"}
    common = {"tolerance": 0.001, "hard_clearance": True}
    assert load_scenario(text).control.solver_options == own | common
    text = "control: {solver: snopt, tolerance: 0.001, hard_clearance: true}"
    assert load_scenario(text).control.solver_options == common


def test_displaced_places_are_elsewhere_than_on_the_map(load_scenario):
    scenario = load_scenario("world: {displaced_places: [{place: pantry, dx: -0.5, dy: 1.9}]}")
    ward = scenario.load_ward()
    mapped, true = ward.place["pantry"], scenario.true_ward(ward).place["pantry"]
    assert (true.x - mapped.x, true.y - mapped.y) == pytest.approx((-0.5, 1.9))
    assert mut.Scenario().true_ward(ward) is ward


def test_the_seed_draws_what_is_displaced_at_random(load_scenario):
    text = "{random_seed: %d, world: {randomly_displaced: [pantry, stove]}}"
    scenarios = [load_scenario(text % seed) for seed in (0, 1, 0)]
    drawn = [scenario.displacements(scenario.load_ward()) for scenario in scenarios]
    assert drawn[0] == drawn[2] != drawn[1]
    assert list(drawn[0]) == ["pantry", "stove"]


def test_obstacles_are_shapes_seen_from_above(load_scenario):
    text = "world: {obstacles: [{name: cart, x: 3, y: 4, yaw: 0.5, half_length: 0.7, half_width: 0.2}]}"
    (shape,) = load_scenario(text).unmapped_shapes
    assert (shape.name, shape.x, shape.y, shape.yaw, shape.half_length, shape.half_width) == (
        "cart",
        3.0,
        4.0,
        0.5,
        0.7,
        0.2,
    )
