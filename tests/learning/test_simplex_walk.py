"""The walk on the simplex forgets where it began, and stays on it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mala_drake.learning import simplex_walk as mut
from mala_drake.learning.rating_evidence import Evidence

NONE = Evidence.none(noise_shape=1.5, noise_scale=1e-3)
CORNER = np.tile([1.0, 0.0, 0.0, 0.0, 0.0], (4000, 1))


def test_without_ratings_it_ends_anywhere_on_the_simplex():
    """Wherever it began; the moments are those of Dirichlet(1, 1, 1, 1, 1)."""
    points = mut.walk_on_simplex(NONE, CORNER)
    np.testing.assert_allclose(points.mean(axis=0), 0.2, atol=0.01)
    np.testing.assert_allclose(np.cov(points.T), (np.eye(5) / 5.0 - 1.0 / 25.0) / 6.0, atol=2e-3)


def test_it_ends_where_the_ratings_say_wherever_it_began():
    """Far from every face the posterior is a t distribution, whose moments are known."""
    truth, features = np.array([0.3, 0.25, 0.2, 0.15, 0.1]), np.array([0.9, 0.4, 0.6, 0.8, 0.5])
    evidence = NONE
    for _ in range(200):
        evidence = evidence.with_values(features, features * truth)
    points = mut.walk_on_simplex(evidence, CORNER)
    freedom = 2.0 * NONE.noise_shape + evidence.count - 4.0
    inverse = 1.0 / evidence.information
    cut = np.diag(inverse) - np.outer(inverse, inverse) / inverse.sum()  # Of weights whose sum is known.
    covariance = 2.0 * NONE.noise_scale / (freedom - 2.0) * cut
    np.testing.assert_allclose(points.mean(axis=0), truth, atol=0.05 * np.sqrt(covariance.max()))
    np.testing.assert_allclose(np.cov(points.T), covariance, atol=0.06 * covariance.max())


@settings(deadline=None, max_examples=25)
@given(
    st.lists(st.tuples(*[st.floats(0.0, 1.0)] * 10), max_size=4),
    st.tuples(*[st.one_of(st.just(0.0), st.floats(1e-9, 1.0))] * 5).filter(any),
)
def test_it_stays_on_the_simplex_whatever_was_rated(history, start):
    evidence = NONE
    for numbers in history:
        evidence = evidence.with_values(np.array(numbers[:5]), np.array(numbers[5:]))
    start = np.tile(np.array(start) / sum(start), (20, 1))
    before = start.copy()
    points = mut.walk_on_simplex(evidence, start)
    assert (start == before).all()
    assert (points >= 0.0).all()
    assert points.sum(axis=1) == pytest.approx(1.0)
