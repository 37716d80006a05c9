import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate, stats

from mala_drake.learning.rating_evidence import Evidence, Observation, censored_belief

NONE = Evidence.none(noise_shape=1.5, noise_scale=1e-3)


def evidence_of(features, values):
    evidence = NONE
    for f, y in zip(features, values, strict=True):
        evidence = evidence.with_values(f, y)
    return evidence


def test_the_sums_give_the_residual_sum_of_squares():
    generator = np.random.Generator(np.random.PCG64(3))
    features, values = generator.random((7, 5)), generator.random((7, 5))
    values[2, 1] = values[4] = math.nan
    evidence = evidence_of(features, values)
    weights = generator.dirichlet(np.ones(5), 3)
    expected = [np.nansum((values - features * w) ** 2) for w in weights]
    np.testing.assert_allclose(evidence.residual_squares(weights), expected)
    assert evidence.count == np.count_nonzero(~np.isnan(values))


def test_the_sums_survive_packing_bit_for_bit():
    evidence = evidence_of(*np.random.Generator(np.random.PCG64(4)).random((2, 3, 5)))
    vector = evidence.packed()
    assert vector.size == Evidence.SIZE
    assert Evidence.unpacked(vector).packed().tobytes() == vector.tobytes()


def test_a_rating_of_exactly_five_or_one_may_have_been_cut():
    rated = np.array([True, True, True, True, False])
    observation = Observation.of(np.array([5.0, 1.0, 5.1, 4.0, 3.0]), np.full(5, 0.5), rated)
    assert observation.clipped_high.tolist() == [True, False, False, False, True]
    assert observation.clipped_low.tolist() == [False, True, False, False, False]
    assert observation.features.tolist() == [0.5, 0.5, 0.5, 0.5, 0.0]  # The unrated one says nothing.
    assert observation.values[3] == 0.25


@given(st.floats(0.1, 1.0), st.booleans(), st.floats(0.05, 0.5), st.floats(0.02, 0.2), st.floats(0.01, 0.1))
def test_a_cut_rating_has_the_moments_of_the_exact_posterior(feature, below, mean, deviation, noise):
    """Against numerical integration of belief times probability of being cut, where that is not negligible."""
    limit = 0.0 if below else 1.0
    sign = 1.0 if below else -1.0

    w = np.linspace(mean - 12.0 * deviation, mean + 12.0 * deviation, 20_001)
    density = stats.norm.pdf(w, mean, deviation) * stats.norm.cdf(sign * (limit - feature * w) / noise)
    total = integrate.trapezoid(density, w)
    factor = censored_belief(feature, limit, below=below, mean=mean, deviation=deviation, noise=noise)
    if total < 1e-6 or factor is None:
        return
    exact_mean = integrate.trapezoid(w * density, w) / total
    exact_variance = integrate.trapezoid((w - exact_mean) ** 2 * density, w) / total
    precision = 1.0 / deviation**2 + 1.0 / factor[1]
    assert 1.0 / precision == pytest.approx(exact_variance, rel=1e-3)
    assert (mean / deviation**2 + factor[0] / factor[1]) / precision == pytest.approx(exact_mean, abs=1e-3 * deviation)


def test_a_cut_that_was_certain_says_nothing():
    assert censored_belief(0.0, 0.0, below=True, mean=0.2, deviation=0.1, noise=0.025) is None
    assert censored_belief(1.0, 0.0, below=True, mean=-9.0, deviation=0.01, noise=0.01) is None


def test_a_cut_that_was_all_but_impossible_still_gives_numbers():
    mean, variance = censored_belief(1.0, 1.0, below=False, mean=0.9, deviation=0.01, noise=0.01)
    assert mean > 0.9
    assert 0.0 < variance < math.inf
    assert censored_belief(1.0, 1.0, below=False, mean=0.0, deviation=0.01, noise=0.01) is None


def test_forgetting_keeps_the_noise_and_nothing_else():
    generator = np.random.Generator(np.random.PCG64(5))
    truth, noise = np.array([0.4, 0.3, 0.1, 0.1, 0.1]), 0.03
    features = generator.uniform(0.2, 0.9, (200, 5))
    evidence = evidence_of(features, features * truth + noise * generator.standard_normal((200, 5)))
    forgotten = evidence.forgotten(truth)
    assert forgotten.count == 0.0
    assert not forgotten.information.any()
    assert math.sqrt(forgotten.noise_variance(np.full(5, 0.2))) == pytest.approx(noise, rel=0.05)
