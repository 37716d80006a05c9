"""Targets learned on simulated legs: a robot that stops near where it is told to, and a place that is elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mala_drake.learning.target_estimator as mut
from mala_drake.errors import BadInput
from mala_drake.grounding.location import LocationMembership
from mala_drake.grounding.mismatch import location_error, location_error_gradient
from mala_drake.messages import LearnedTargets

PLACES = {"pantry": (-3.0, 15.0), "stove": (-3.0, 20.5)}
STOPPING = 0.10  # Metres from its target at which the robot may stop.

angles = st.floats(0.0, 2 * np.pi)
displacements = st.floats(1.5, 4.0)


def polar(length, angle):
    return length * np.array([np.cos(angle), np.sin(angle)])


class Legs:
    """Drives to the pantry of a ward where it is displaced, with an affine law from target to reached position."""

    def __init__(self, displacement, *, sensitivity=None, noise=0.0, seed=0, geometric=False, is_free=None, **settings):
        self.estimator = mut.TargetEstimator(PLACES, **settings)
        self.true = np.array(PLACES["pantry"]) + displacement
        self.location = LocationMembership(tuple(self.true))
        self.state = self.estimator.initial_state()
        self._sensitivity = np.eye(2) if sensitivity is None else sensitivity
        self._noise, self._generator = noise, np.random.default_rng(seed)
        self._geometric, self._is_free = geometric, is_free

    @property
    def target(self):
        return np.array(self.estimator.target(self.state, "pantry"))

    @property
    def distance(self):
        return float(np.linalg.norm(self.target - self.true))

    def reached(self):
        stopped = polar(self._noise, self._generator.uniform(0.0, 2 * np.pi))
        nominal = np.array(PLACES["pantry"])
        return nominal + self._sensitivity @ (self.target - nominal) + stopped

    def drive(self):
        """One leg and its update; returns the mismatch that was found."""
        position = self.reached()
        error = float(location_error(self.location, position))
        missing = mut.MissingAtom(error, location_error_gradient(self.location, position) @ self._sensitivity)
        offset = self.true - position if self._geometric else None
        evidence = mut.TargetEvidence((missing,), offset, self._sensitivity)
        self.state = self.estimator.update(self.state, "pantry", evidence, is_free=self._is_free)
        return error


@settings(deadline=None)
@given(displacements, angles, st.integers(0, 9))
def test_by_the_mismatch_alone_any_target_is_on_the_plateau_within_six_updates(length, angle, seed):
    legs = Legs(polar(length, angle), noise=STOPPING, seed=seed)
    errors = [legs.drive() for _ in range(7)]
    assert errors[0] > 0.0
    # The target is on the plateau; a robot that stops beside it may still be just beyond the edge.
    assert legs.distance <= 1.0
    assert errors[6] <= STOPPING / 4.0
    assert legs.estimator.updates(legs.state, "pantry") <= 6


@settings(deadline=None)
@given(displacements, angles, st.integers(0, 9))
def test_with_the_geometric_error_any_target_is_found_within_six_updates(length, angle, seed):
    legs = Legs(polar(length, angle), noise=STOPPING, seed=seed, geometric=True)
    for _ in range(6):
        legs.drive()
    assert legs.distance <= 0.15
    for _ in range(30):  # And stays found.
        legs.drive()
        assert legs.distance <= 0.15


@settings(deadline=None)
@given(displacements, angles, st.floats(0.6, 1.6), st.floats(0.6, 1.6), angles)
def test_legs_that_do_not_move_as_their_target_does_are_allowed_for(length, angle, first, second, turn):
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    sensitivity = rotation @ np.diag([first, second]) @ rotation.T
    for geometric in (False, True):
        legs = Legs(polar(length, angle), sensitivity=sensitivity, geometric=geometric, farthest=10.0)
        for _ in range(6):
            legs.drive()
        assert legs.drive() == 0.0
        if geometric:
            assert np.linalg.norm(legs.reached() - legs.true) <= 0.05


def test_the_step_is_that_of_gauss_and_newton():
    legs = Legs((3.0, 0.0))
    legs.drive()
    # 2 m to the plateau's edge and the margin past it, along the gradient.
    np.testing.assert_allclose(legs.target, (-3.0 + 2.3, 15.0), atol=1e-12)


def test_no_update_moves_a_target_farther_than_its_trust_radius():
    legs = Legs((4.0, 0.0), trust_radius=0.5, decay=1.0)
    moves, before = [], legs.target
    for _ in range(4):
        legs.drive()
        moves.append(float(np.linalg.norm(legs.target - before)))
        before = legs.target
    np.testing.assert_allclose(moves, 0.5 / np.arange(1.0, 5.0))


def test_beyond_the_support_the_mismatch_says_nothing():
    legs = Legs((6.0, 0.0))
    assert legs.drive() == 1.0
    assert not legs.state.any()
    assert legs.estimator.learned(legs.state) == LearnedTargets()


def test_on_the_plateau_the_mismatch_is_gone():
    legs = Legs((0.7, 0.6))
    assert legs.drive() == 0.0
    assert not legs.state.any()


def test_a_target_is_never_where_the_robot_cannot_stand():
    nominal = np.array(PLACES["pantry"])
    blocked = Legs((4.0, 0.0), is_free=lambda point: point[0] < nominal[0] + 1.3)
    blocked.drive()
    assert blocked.target[0] == pytest.approx(nominal[0] + 0.5 * 2.5)  # The longest share of the step that is free.
    walled_in = Legs((4.0, 0.0), is_free=lambda point: point[0] < nominal[0] + 0.1)
    walled_in.drive()
    assert not walled_in.state.any()


def test_what_stands_at_the_edge_of_the_plateau_is_passed_if_the_mismatch_alone_is_to_go_by():
    x = PLACES["pantry"][0]
    legs = Legs((2.25, 0.0), is_free=lambda point: not 1.3 < point[0] - x < 1.9)
    legs.drive()
    assert legs.target[0] - x == pytest.approx(1.25 + 0.3 + 0.5)
    assert legs.drive() == 0.0


def test_a_step_goes_aside_where_the_way_on_is_taken():
    x, y = PLACES["pantry"]
    legs = Legs((2.0, 0.0), is_free=lambda point: not (1.2 < point[0] - x < 4.0 and abs(point[1] - y) < 0.6))
    legs.drive()
    aside = legs.target - (x, y)
    assert aside[0] >= 1.3 - 1e-9  # As far towards the place as straight on.
    assert 0.6 <= abs(aside[1]) <= 1.3 * np.tan(np.radians(30.0)) + 1e-9  # And no farther aside than needed.


def test_what_stands_between_the_target_and_the_place_is_passed_beyond_the_trust_radius():
    x = PLACES["pantry"][0]
    legs = Legs((3.3, 0.0), is_free=lambda point: not 0.9 < point[0] - x < 3.0, geometric=True)
    for _ in range(3):
        legs.drive()
    assert legs.distance <= 0.05


def test_a_target_never_leaves_its_surroundings():
    legs = Legs((4.9, 0.0), geometric=True, farthest=3.0)
    for _ in range(20):
        legs.drive()
    assert np.linalg.norm(legs.target - PLACES["pantry"]) <= 3.0


def test_a_direction_in_which_the_leg_does_not_move_is_left_alone():
    legs = Legs((1.0, 2.0), sensitivity=np.diag([1.0, 1e-4]), geometric=True)
    legs.drive()
    moved = legs.target - PLACES["pantry"]
    assert moved[0] == pytest.approx(1.0, abs=0.1)
    assert abs(moved[1]) < 0.1


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_and_unknown_places_teach_nothing(bad):
    estimator = mut.TargetEstimator(PLACES)
    state = estimator.initial_state()
    atom = mut.MissingAtom(0.5, np.array([0.25, 0.0]))
    good = mut.TargetEvidence((atom,), None, np.eye(2))
    assert estimator.update(state, "pantry", good).any()
    assert not estimator.update(state, "elsewhere", good).any()
    for evidence in (
        mut.TargetEvidence((mut.MissingAtom(bad, np.array([0.25, 0.0])),), None, np.eye(2)),
        mut.TargetEvidence((mut.MissingAtom(0.5, np.array([bad, 0.0])),), None, np.eye(2)),
        mut.TargetEvidence((atom,), np.array([bad, 0.0]), np.eye(2)),
        mut.TargetEvidence((atom,), None, np.full((2, 2), bad)),
        mut.TargetEvidence((atom,), None, np.eye(2), (bad, 0.0)),
    ):
        assert not estimator.update(state, "pantry", evidence).any()
    assert not state.any()


def test_each_place_learns_for_itself_and_is_told_of():
    legs = Legs((2.0, 0.0))
    legs.drive()
    assert legs.estimator.target(legs.state, "stove") == PLACES["stove"]
    assert legs.estimator.learned(legs.state) == LearnedTargets((("pantry", *legs.target.tolist()),), 1)


def test_what_was_learned_is_restored_bit_for_bit():
    legs = Legs((2.0, -1.0), noise=STOPPING, geometric=True)
    legs.drive()
    restored = legs.estimator.restore(legs.estimator.save(legs.state))
    np.testing.assert_array_equal(restored, legs.state)


@pytest.mark.parametrize(
    "wrong", [{"tolerance": 0.0}, {"trust_radius": -1.0}, {"decay": -0.1}, {"farthest": np.nan}, {"decay": np.inf}]
)
def test_settings_out_of_range_are_refused(wrong):
    with pytest.raises(BadInput, match=next(iter(wrong))):
        mut.TargetEstimator(PLACES, **wrong)


def test_a_place_that_is_nowhere_is_refused():
    with pytest.raises(BadInput, match="nominal target pantry"):
        mut.TargetEstimator({"pantry": (np.nan, 0.0)})


def test_a_step_stops_at_the_trust_radius_unless_that_were_at_the_edge_of_the_plateau():
    legs = Legs((3.45, 0.0))  # 2.45 m to the edge: the trust radius of 2.5 m would end on it.
    legs.drive()
    assert legs.target[0] == pytest.approx(PLACES["pantry"][0] + 2.45 + mut.PLATEAU_MARGIN)
    legs = Legs((3.55, 0.0))
    legs.drive()
    assert legs.target[0] == pytest.approx(PLACES["pantry"][0] + 2.5)


def test_what_is_said_of_an_earlier_target_moves_on_from_that():
    estimator = mut.TargetEstimator(PLACES)
    atom = mut.MissingAtom(0.25, np.array([-0.25, 0.0]))
    once = estimator.update(estimator.initial_state(), "pantry", mut.TargetEvidence((atom,), None, np.eye(2)))
    assert estimator.target(once, "pantry") == pytest.approx((-3.0 + 1.3, 15.0))
    about = mut.TargetEvidence((atom,), None, np.eye(2), PLACES["pantry"])
    again = estimator.update(once, "pantry", about)
    assert estimator.target(again, "pantry") == pytest.approx((-3.0 + 1.3, 15.0))
    assert estimator.updates(again, "pantry") == 2


def test_all_missing_atoms_come_true_at_once():
    """Being at a place, and having something within reach that is beyond it to the side."""
    estimator, start = mut.TargetEstimator(PLACES), np.array(PLACES["pantry"])
    place, item, reach = LocationMembership((-1.0, 15.0)), np.array([-1.0, 16.5]), 0.9

    def missing(position):
        short = max(np.linalg.norm(item - position) - reach, 0.0)
        towards = (item - position) / np.linalg.norm(item - position)
        return (
            mut.MissingAtom(float(location_error(place, position)), location_error_gradient(place, position)),
            mut.MissingAtom(short / 4.0, -towards / 4.0, 0.15),
        )

    state, reached = estimator.initial_state(), start
    for _ in range(3):  # The direction to the item turns on the way.
        state = estimator.update(state, "pantry", mut.TargetEvidence(missing(reached), None, np.eye(2)))
        reached = np.array(estimator.target(state, "pantry"))
    assert all(atom.error == 0.0 for atom in missing(reached))
