import itertools

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mala_drake.grounding import LukasiewiczNorms, MinimumNorms, ProductNorms, Threshold, best_state

values_of_four = st.lists(st.floats(0.0, 1.0), min_size=4, max_size=4)
candidates = st.lists(st.lists(st.booleans(), min_size=4, max_size=4), min_size=1, max_size=8)


@given(values_of_four, candidates)
def test_it_is_the_one_a_plain_search_finds(values, states):
    truths = [min(v if holds else 1.0 - v for v, holds in zip(values, state, strict=True)) for state in states]
    best = best_state(values, states, norms=MinimumNorms())
    if max(truths) == 0.0:
        assert best is None
    else:
        assert best is not None
        assert (best.index, best.truth) == (truths.index(max(truths)), max(truths))


@given(values_of_four, st.sampled_from([MinimumNorms(), ProductNorms()]))
def test_with_every_state_allowed_it_is_what_is_more_true_than_not(values, norms):
    assume(all(abs(value - 0.5) > 1e-6 for value in values))
    states = np.array(list(itertools.product([False, True], repeat=4)))
    best = best_state(values, states, norms=norms)
    assert best is not None
    wanted = Threshold(0.5).crisp(values)
    if isinstance(norms, ProductNorms):
        np.testing.assert_array_equal(states[best.index], wanted)
    else:  # The minimum looks at the least certain atom only and may tie: the wanted state is among the best.
        assert best.truth == pytest.approx(min(max(value, 1.0 - value) for value in values))


def test_exclusive_places_are_told_apart_although_both_are_likely():
    places = [[True, False, False], [False, True, False], [False, False, True], [False, False, False]]
    best = best_state([0.75, 0.8, 0.0], places, norms=ProductNorms())
    assert best is not None
    assert best.index == 1


def test_a_strict_logic_may_see_no_state_at_all():
    assert best_state([0.5, 0.5, 0.5], [[True] * 3, [False] * 3], norms=LukasiewiczNorms()) is None


def test_nothing_follows_from_no_candidates_or_no_numbers():
    assert best_state([0.5], np.zeros((0, 1), dtype=bool), norms=MinimumNorms()) is None
    assert best_state([np.nan], [[True], [False]], norms=MinimumNorms()) is None
