import itertools

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mala_drake.grounding import (
    LukasiewiczNorms,
    MinimumNorms,
    ProductNorms,
    fuzzy_state,
    state_truth,
    state_truth_gradient,
)

AT_A, AT_B = ("at", "robot1", "a"), ("at", "robot1", "b")
HOLDING, CHECKED = ("has-medication", "robot1"), ("correct-medication", "robot1")
families = st.sampled_from([MinimumNorms(), ProductNorms(), LukasiewiczNorms()])
observations = st.lists(st.floats(0.0, 1.0), min_size=1, max_size=5)
STEP = 1e-6


def test_an_observed_atom_has_its_membership_whatever_was_expected():
    truths = fuzzy_state({AT_A: 0.9, AT_B: 0.1}, state=[AT_A], effects={AT_A: 0.0, AT_B: 1.0})
    assert truths == {AT_A: 0.9, AT_B: 0.1}


def test_an_unobserved_atom_has_what_the_action_should_have_made_of_it():
    truths = fuzzy_state({}, state=[HOLDING], effects={HOLDING: 0.0, CHECKED: 0.95})
    assert truths == {HOLDING: 0.0, CHECKED: 0.95}


def test_an_atom_that_nobody_touched_stays_true():
    assert fuzzy_state({AT_B: 1.0}, state=[HOLDING], effects={AT_B: 1.0})[HOLDING] == 1.0


def test_atoms_come_in_one_order():
    one = fuzzy_state({AT_B: 0.2, AT_A: 0.1}, state=[HOLDING, CHECKED], effects={})
    other = fuzzy_state({AT_A: 0.1, AT_B: 0.2}, state={CHECKED, HOLDING}, effects={})
    assert list(one) == list(other) == sorted(one)


def test_the_truth_of_a_state_joins_what_holds_and_what_does_not():
    values, state = [0.9, 0.2], [True, False]
    assert state_truth(values, state, norms=MinimumNorms()) == pytest.approx(0.8)
    assert state_truth(values, state, norms=ProductNorms()) == pytest.approx(0.72)
    assert state_truth(values, state, norms=LukasiewiczNorms()) == pytest.approx(0.7)


@given(observations)
def test_under_the_product_the_truths_of_all_states_are_a_probability_distribution(values):
    states = list(itertools.product([False, True], repeat=len(values)))
    assert np.sum(state_truth(values, states, norms=ProductNorms())) == pytest.approx(1.0)


@given(families, st.lists(st.booleans(), min_size=1, max_size=5))
def test_a_crisp_observation_shows_exactly_one_state(norms, state):
    values = np.array(state, dtype=float)
    for other in itertools.product([False, True], repeat=len(state)):
        assert state_truth(values, other, norms=norms) == float(other == tuple(state))


@given(families, st.data())
def test_the_gradient_is_that_of_finite_differences_away_from_kinks(norms, data):
    values = np.array(data.draw(observations))
    state = np.array(data.draw(st.lists(st.booleans(), min_size=values.size, max_size=values.size)))
    steps = STEP * np.eye(values.size)

    def truth(at):
        return state_truth(at, state, norms=norms)

    forward, backward = (truth(values + steps) - truth(values)) / STEP, (truth(values) - truth(values - steps)) / STEP
    assume(np.allclose(forward, backward, atol=1e-4))
    assume(np.all((values > 2 * STEP) & (values < 1.0 - 2 * STEP)))
    np.testing.assert_allclose(state_truth_gradient(values, state, norms=norms), forward, atol=1e-4)
