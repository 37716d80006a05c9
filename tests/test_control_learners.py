"""The learners that tell the controller something: those that a scenario wants, with what its controller has."""

from __future__ import annotations

import pytest

from mala_drake import control_learners as mut
from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.scenario import ControlConfig, Scenario
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.legs import leg_planner


@pytest.fixture(scope="module")
def congestion(ward):
    return Congestion(ward)


@pytest.fixture(scope="module")
def make(ward, congestion):
    guide = LegGuide(leg_planner(ward), congestion, ward.shapes, LegRules())

    def learners(**control):
        return mut.make_control_learners(Scenario(control=ControlConfig(**control)), ward, guide, congestion)

    return learners


@pytest.mark.parametrize(
    ("wanted", "names"),
    [
        ({}, []),
        ({"learned_targets": True}, ["target_learner"]),
        ({"learned_dynamics": True}, ["dynamics_learner"]),
        ({"learned_weights": True}, ["weight_learner"]),
        ({"learned_translation": True}, ["weight_learner"]),
        (
            {"learned_targets": True, "learned_dynamics": True, "learned_weights": True},
            ["target_learner", "dynamics_learner", "weight_learner"],
        ),
    ],
)
def test_the_learners_are_those_that_the_scenario_wants(make, wanted, names):
    assert list(make(**wanted)) == names


@pytest.mark.parametrize("solver", ["rti", "snopt"])
def test_who_simulates_legs_has_a_solver_of_its_own_that_is_as_the_controllers(make, monkeypatch, solver):
    made = []
    monkeypatch.setattr(mut, "MakeSolver", lambda name, _, **options: made.append((name, options)))
    control = {"solver": solver, "tolerance": 1e-3}
    make(learned_targets=True, learned_weights=True, **control)
    assert made == [(solver, ControlConfig(**control).solver_options)] * 2


def test_targets_that_are_learned_through_the_identity_need_no_simulated_legs(make, monkeypatch):
    monkeypatch.setattr(mut, "MakeSolver", None)
    assert list(make(learned_targets=True, target_sensitivity="identity")) == ["target_learner"]
