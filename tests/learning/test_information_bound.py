import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.errors import BadInput
from mala_drake.learning.information_bound import efficiency, sum_zero_basis, weight_bound


@given(st.integers(2, 8))
def test_the_basis_is_orthonormal_and_sums_to_zero(size):
    basis = sum_zero_basis(size)
    np.testing.assert_allclose(basis.T @ basis, np.eye(size - 1), atol=1e-12)
    np.testing.assert_allclose(basis.sum(axis=0), 0.0, atol=1e-12)


def test_with_equal_features_the_constraint_takes_a_fifth_of_the_variance():
    bound = weight_bound(np.full((10, 5), 0.5), noise=0.1)
    unconstrained = 0.1 / (4.0 * math.sqrt(10 * 0.25))
    np.testing.assert_allclose(bound, unconstrained * math.sqrt(4.0 / 5.0))


def test_the_constrained_least_squares_estimate_attains_it():
    """Lagrange's closed form for least squares with sum(w) = 1, simulated many times."""
    generator = np.random.Generator(np.random.PCG64(1))
    features, truth, noise = generator.uniform(0.2, 0.9, (6, 5)), np.array([0.3, 0.25, 0.2, 0.15, 0.1]), 0.1
    information = (features**2).sum(axis=0)
    ratings = 5.0 - 4.0 * features * truth + noise * generator.standard_normal((4000, 6, 5))
    free = (features * (5.0 - ratings) / 4.0).sum(axis=1) / information
    estimates = free + (1.0 - free.sum(axis=1, keepdims=True)) / information / (1.0 / information).sum()
    bound = weight_bound(features, noise)
    np.testing.assert_allclose(estimates.std(axis=0), bound, rtol=0.04)
    assert efficiency(list(estimates - truth), [bound] * len(estimates)) == pytest.approx(1.0, abs=0.02)


def test_weights_that_are_not_seen_are_unbounded_and_leave_the_others_as_they_are():
    """The others' bound is the limit of the closed form as what is told of the unseen ones vanishes."""
    for features in ([0.5, 0.0, 0.25, 0.0, 0.5], [0.5, 0.4, 0.3, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.7]):
        unseen = np.equal(features, 0.0)
        bound = weight_bound([features], 0.1)
        np.testing.assert_array_equal(np.isinf(bound), unseen)
        limit = weight_bound([np.where(unseen, 1e-5, features)], 0.1)
        np.testing.assert_allclose(bound[~unseen], limit[~unseen], rtol=1e-6)
    assert np.isinf(weight_bound([[math.nan] * 5], 0.1)).all()


def test_one_unseen_weight_is_known_from_the_sum_of_the_others():
    features = np.array([0.5, 0.25, 0.4, 0.0, 0.5])
    bound = weight_bound([features], 0.1)
    seen = 0.1 / (4.0 * features[features > 0.0])
    np.testing.assert_allclose(bound[features > 0.0], seen)
    assert bound[3] == pytest.approx(np.linalg.norm(seen))


def test_missing_ratings_carry_no_information():
    seen, missing = [0.5, 0.4, 0.3, 0.6, 0.7], [math.nan] * 5
    np.testing.assert_array_equal(weight_bound([seen, missing], 0.1), weight_bound([seen], 0.1))


@pytest.mark.parametrize(("features", "noise"), [([[0.5] * 5], 0.0), ([0.5] * 5, 0.1)])
def test_what_cannot_be_a_bound_is_refused(features, noise):
    with pytest.raises(BadInput):
        weight_bound(features, noise)
