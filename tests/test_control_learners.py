"""The learners that tell the controller something: those that a scenario wants, with what its controller has."""

from __future__ import annotations

import numpy as np
import pytest

from mala_drake import control_learners as mut
from mala_drake.control.leg import LegGuide, LegRules
from mala_drake.control.sensitivities.leg_simulator import LegSimulator
from mala_drake.control.solver_by_horizon import SHORTEST_HORIZON, solver_of_kind
from mala_drake.learning.dynamics_estimator import Transition
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


@pytest.mark.parametrize(("solver", "kind"), [("rti", "receding"), ("snopt", "receding"), ("rti", "shrinking")])
def test_who_simulates_legs_has_a_solver_of_its_own_that_is_as_the_controllers(make, monkeypatch, solver, kind):
    made = []

    def listen(kind, name, problem, **options):
        made.append((kind, name, problem.horizon, options))
        return solver_of_kind(kind, name, problem, **options)

    monkeypatch.setattr(mut, "solver_of_kind", listen)
    control = {"solver": solver, "tolerance": 1e-3, "horizon": 8, "horizon_kind": kind}
    make(learned_targets=True, learned_weights=True, **control)
    assert made == [(kind, solver, 8, ControlConfig(**control).solver_options)] * 2


@pytest.mark.parametrize(("kind", "shortest"), [("receding", None), ("shrinking", SHORTEST_HORIZON)])
def test_legs_are_simulated_with_the_controllers_kind_of_horizon(make, monkeypatch, kind, shortest):
    simulators = []

    def listen(*arguments, **options):
        simulators.append(options)
        return LegSimulator(*arguments, **options)

    monkeypatch.setattr(mut, "LegSimulator", listen)
    make(learned_targets=True, learned_translation=True, horizon_kind=kind)
    assert simulators == [{"shortest_horizon": shortest}] * 2


def test_targets_that_are_learned_through_the_identity_need_no_simulated_legs(make, monkeypatch):
    monkeypatch.setattr(mut, "LegSimulator", None)
    assert list(make(learned_targets=True, target_sensitivity="identity")) == ["target_learner"]


def test_the_dynamics_are_estimated_knowing_the_noise_of_what_is_measured():
    """A motion that is as far from its rates as such noise makes it is learned from, without noise it is not."""
    after = np.array([0.2, 0.0, 0.0, 1.1, 0.0, 0.0])
    transition = Transition(np.array([0.0, 0.0, 0.0, 1.1, 0.0, 0.0]), np.array([0.1, 0.0, 0.0]), after)
    quiet, noisy = Scenario(), Scenario()
    noisy.robot.velocity_noise = 0.05
    assert not mut.dynamics_estimator(quiet).describes(transition)
    assert mut.dynamics_estimator(noisy).describes(transition)
