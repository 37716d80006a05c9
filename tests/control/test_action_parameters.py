"""What an action chooses about the optimal control problem, group by group (paper, Sec. "Action-Triggered MPC")."""

from __future__ import annotations

import numpy as np
import pytest

from mala_drake.control import action_parameters as mut
from mala_drake.control.optimal_control_problem import OptimalControlProblem
from mala_drake.control.reference import Reference
from mala_drake.control.solver import MakeSolver
from mala_drake.messages import Action, ActionKind, LearnedWeights
from mala_drake.patient.profiles import PROFILES
from mala_drake.preferences import UNIFORM_WEIGHTS
from mala_drake.ward.congestion import Congestion
from mala_drake.ward.ward_map import Ward, Zone

CROWD = Zone("crowd", 0.5, ((-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)))


def parameters(
    name="go_to_pharmacy_north",
    *,
    carrying=False,
    goal=8.0,
    zones=(),
    weights=UNIFORM_WEIGHTS,
    learned=LearnedWeights(),  # noqa: B008 (a value)
    place="",
):
    states = np.zeros((21, 6))
    states[:, 0] = np.linspace(0.0, goal, 21)
    states[:-1, 3] = goal / 4.0
    style = mut.learned_style(Action(1, ActionKind.MOVE, name, place=place), learned, carrying=carrying)
    congestion = Congestion(Ward("hall", 20.0, 0.2, 2.0, (), (), zones, 0.02))
    return mut.make_parameters(
        style=style, weights=weights, reference=Reference(states), obstacles=(), congestion=congestion
    )


@pytest.fixture(scope="module")
def solver():
    return MakeSolver("snopt", OptimalControlProblem())


CHANGES = {
    "terminal": {"goal": 5.0},
    "stage": {"name": "approach_left_to_bed", "carrying": True},
    "dynamics": {"carrying": True},
    "constraints": {"zones": (CROWD,)},
    "inputs": {"carrying": True},
}


@pytest.mark.parametrize("group", CHANGES)
def test_two_actions_differ_in_each_group_and_the_solution_shows_it(group, solver):
    plain, changed = parameters(), parameters(**CHANGES[group])
    if group == "stage":
        plain = parameters(carrying=True)
    before, after = getattr(plain, group), getattr(changed, group)
    flat = [np.concatenate([np.ravel(getattr(g, n)) for n in g.__slots__ if n != "obstacles"]) for g in (before, after)]
    assert not np.allclose(*flat)
    start = np.array([0.0, 0.0, 0.0, 1.2, 0.0, 0.0])
    first, second = solver.solve(start, plain), solver.solve(start, changed)
    assert first.success
    assert second.success
    assert np.abs(first.states - second.states).max() > 1e-3


def test_near_the_patient_the_weights_are_those_of_the_facts():
    bedside = parameters("approach_left_to_bed", carrying=True)
    assert bedside.stage.state_weights[:2] == pytest.approx([36.0, 36.0])
    assert bedside.stage.control_weights == pytest.approx([3.6, 3.6, 2.77], abs=0.03)


def test_learned_factors_are_for_the_place_that_the_action_leads_to():
    learned = LearnedWeights(factors=(("pantry", (2.0, 0.5, 3.0, 0.25)),))
    plain = parameters("approach_left_to_bed")
    there = parameters("approach_left_to_bed", learned=learned, place="pantry")
    np.testing.assert_allclose(there.stage.state_weights / plain.stage.state_weights, [2.0, 2.0, 0.5, 3.0, 3.0, 3.0])
    np.testing.assert_allclose(there.terminal.weights / plain.terminal.weights, [2.0, 2.0, 0.5, 3.0, 3.0, 3.0])
    np.testing.assert_allclose(there.stage.control_weights / plain.stage.control_weights, [0.25] * 3)
    elsewhere = parameters("approach_left_to_bed", learned=learned, place="stove")
    np.testing.assert_array_equal(elsewhere.stage.state_weights, plain.stage.state_weights)
    np.testing.assert_array_equal(elsewhere.stage.control_weights, plain.stage.control_weights)


def test_the_terminal_weight_is_a_hundred_times_the_stage_weight():
    group = parameters()
    assert group.terminal.weights == pytest.approx(100 * group.stage.state_weights)


def test_congestion_limits_the_speed():
    assert parameters(zones=(CROWD,)).constraints.speed_limits[:5] == pytest.approx([1.5 / 1.5] * 5)


def test_two_profiles_drive_measurably_differently(solver):
    start = np.array([0.0, 0.4, 0.0, 0.0, 0.0, 0.0])
    fast = solver.solve(start, parameters(weights=PROFILES["speed_oriented"]))
    frugal = solver.solve(start, parameters(weights=PROFILES["energy_conscious"]))
    assert np.abs(fast.states - frugal.states).max() > 0.02
