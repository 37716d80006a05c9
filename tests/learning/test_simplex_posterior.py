import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mala_drake.learning.rating_evidence import Evidence
from mala_drake.learning.simplex_posterior import simplex_posterior

NOISE = 0.025


def evidence_of(episodes, truth, *, seed=0, low=0.2, high=0.9, noise=NOISE):
    generator = np.random.Generator(np.random.PCG64(seed))
    evidence = Evidence.none(noise_shape=1.5, noise_scale=1.5 * NOISE**2)
    for _ in range(episodes):
        features = generator.uniform(low, high, 5)
        evidence = evidence.with_values(features, features * truth + noise * generator.standard_normal(5))
    return evidence


def faint(strengths, truth, *, seed=0, episodes=40, noise=NOISE):
    """Some criteria always have much smaller features than others."""
    generator = np.random.Generator(np.random.PCG64(seed))
    evidence = Evidence.none(noise_shape=1.5, noise_scale=1.5 * NOISE**2)
    for _ in range(episodes):
        features = np.array(strengths) * generator.uniform(0.8, 1.1, 5)
        evidence = evidence.with_values(features, features * truth + noise * generator.standard_normal(5))
    return evidence


def metropolis(evidence, steps=150_000):
    """An independent sampler of the same density: a random walk within the simplex, with steps of all lengths."""
    generator = np.random.Generator(np.random.PCG64(99))
    exponent = evidence.noise_shape + 0.5 * evidence.count

    def log_density(w):
        return -exponent * math.log(evidence.noise_scale + 0.5 * max(float(evidence.residual_squares(w)), 0.0))

    lengths = 1.0 / np.sqrt(evidence.information / evidence.noise_variance(np.full(5, 0.2)) + 40.0)
    w, density, kept = np.full(5, 0.2), -math.inf, []
    for step in range(steps):
        move = lengths * generator.standard_normal(5) * 10.0 ** generator.uniform(-2.0, 0.3)
        proposal = w + move - move.mean()
        if (proposal >= 0.0).all():
            proposed = log_density(proposal)
            if math.log(generator.random()) < proposed - density:
                w, density = proposal, proposed
        if step > 20_000:
            kept.append(w)
    return np.array(kept)


def test_before_any_rating_it_is_the_uniform_distribution_of_the_simplex():
    posterior = simplex_posterior(evidence_of(0, np.full(5, 0.2)))
    np.testing.assert_allclose(posterior.mean, 0.2, atol=0.01)
    np.testing.assert_allclose(posterior.deviation, math.sqrt(4.0 / 150.0), rtol=0.05)  # Of Dirichlet(1, 1, 1, 1, 1).
    lower, upper = posterior.interval(0.9).T  # Beta(1, 4) quantiles.
    np.testing.assert_allclose(lower, 1.0 - 0.95**0.25, atol=0.004)
    np.testing.assert_allclose(upper, 1.0 - 0.05**0.25, atol=0.03)


@pytest.mark.parametrize(
    "evidence",
    [
        evidence_of(1, np.array((0.5, 0.12, 0.14, 0.14, 0.1))),
        evidence_of(25, np.array((0.05, 0.1, 0.05, 0.2, 0.6))),
        # In a corner hardly any of the drawn points are on the simplex.
        evidence_of(3, np.array((0.97, 0.03, 0.0, 0.0, 0.0))),
        evidence_of(40, np.array((1.0, 0.0, 0.0, 0.0, 0.0)), noise=0.002),
        # What is hardly seen has hardly any room beside what is known well.
        faint((0.9, 0.9, 0.05, 0.05, 0.05), np.array((0.5, 0.5, 0.0, 0.0, 0.0)), noise=0.0125),
        faint((0.05, 0.7, 0.7, 0.7, 0.05), np.array((0.05, 0.1, 0.05, 0.2, 0.6)), noise=0.0125, seed=1),
    ],
    ids=["vague", "sharp", "corner", "sharp corner", "sharp edge", "two faint"],
)
def test_moments_and_intervals_are_those_of_an_independent_sampler(evidence):
    posterior, sample = simplex_posterior(evidence), metropolis(evidence)
    deviation = sample.std(axis=0)
    np.testing.assert_array_less(np.abs(posterior.mean - sample.mean(axis=0)), 0.2 * deviation)
    np.testing.assert_allclose(posterior.deviation, deviation, rtol=0.12)
    ends = np.quantile(sample, [0.05, 0.95], axis=0).T
    np.testing.assert_array_less(np.abs(posterior.interval(0.9) - ends).max(axis=1), 0.3 * deviation)


@given(st.integers(0, 60), st.lists(st.floats(0.001, 1.0), min_size=5, max_size=5), st.integers(0, 1000))
def test_everything_about_it_lies_on_the_simplex(episodes, truth, seed):
    truth = np.array(truth) / sum(truth)
    posterior = simplex_posterior(evidence_of(episodes, truth, seed=seed))
    for weights in (posterior.mean, posterior.draw(np.random.Generator(np.random.PCG64(seed)))):
        assert weights.sum() == pytest.approx(1.0)
        assert (weights >= 0.0).all()
    assert posterior.effective_size >= 300.0
    lower, upper = posterior.interval(0.9).T
    assert (lower >= 0.0).all()
    assert (lower <= posterior.mean).all()
    assert (posterior.mean <= upper).all()


def test_draws_have_the_distributions_spread():
    posterior = simplex_posterior(evidence_of(2, np.array([0.4, 0.3, 0.1, 0.1, 0.1])))
    generator = np.random.Generator(np.random.PCG64(0))
    draws = np.array([posterior.draw(generator) for _ in range(4000)])
    np.testing.assert_allclose(draws.mean(axis=0), posterior.mean, atol=0.1 * posterior.deviation.max())
    np.testing.assert_allclose(draws.std(axis=0), posterior.deviation, rtol=0.1)
