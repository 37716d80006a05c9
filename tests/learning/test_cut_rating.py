"""What a cut rating says, against numerical integration."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy import integrate, stats

from mala_drake.learning import cut_rating as mut


def exact(feature, limit, *, below, mean, deviation, noise):
    """Mean and variance of the weight and mean square of the noise, given the cut; None if it all but never happens."""
    sign = 1.0 if below else -1.0
    w = np.linspace(mean - 12.0 * deviation, mean + 12.0 * deviation, 20_001)
    z = sign * (limit - feature * w) / noise
    cut = stats.norm.cdf(z)
    density = stats.norm.pdf(w, mean, deviation)
    total = integrate.trapezoid(density * cut, w)
    if total < 1e-6:
        return None
    expected = integrate.trapezoid(w * density * cut, w) / total
    variance = integrate.trapezoid((w - expected) ** 2 * density * cut, w) / total
    squares = noise**2 * (cut - z * stats.norm.pdf(z))  # Of the noise where it is below its limit: by parts.
    return expected, variance, integrate.trapezoid(squares * density, w) / total


@given(st.floats(0.1, 1.0), st.booleans(), st.floats(0.05, 0.5), st.floats(0.02, 0.2), st.floats(0.01, 0.1))
def test_it_has_the_moments_of_the_exact_posterior(feature, below, mean, deviation, noise):
    limit = 0.0 if below else 1.0
    belief = {"below": below, "mean": mean, "deviation": deviation, "noise": noise}
    moments = exact(feature, limit, **belief)
    assume(moments is not None)
    expected, variance, squares = moments
    cut = mut.cut_rating(feature, limit, **belief)
    precision = 1.0 / deviation**2 + cut.precision / noise**2
    after = (mean / deviation**2 + cut.precision * cut.mean / noise**2) / precision
    assert 1.0 / precision == pytest.approx(variance, rel=1e-3)
    assert after == pytest.approx(expected, abs=1e-3 * deviation)

    residual = cut.precision * (after - cut.mean) ** 2 + cut.squares  # What it adds to RSS there.
    assert residual - cut.count * noise**2 == pytest.approx(squares - noise**2, abs=2e-3 * noise**2)
    assert 0.0 <= cut.count <= 1.0
    assert residual >= -1e-9 * noise**2


def test_a_cut_that_was_certain_says_nothing():
    for cut in (
        mut.cut_rating(1.0, 0.0, below=True, mean=-9.0, deviation=0.01, noise=0.01),
        mut.cut_rating(0.5, 1.0, below=True, mean=0.2, deviation=0.01, noise=0.01),
    ):
        assert (cut.precision, cut.mean) == (0.0, 0.0)
        assert (cut.count, cut.squares) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_a_cut_that_was_all_but_impossible_still_gives_numbers():
    cut = mut.cut_rating(1.0, 1.0, below=False, mean=0.9, deviation=0.01, noise=0.01)
    assert cut.mean > 0.9
    assert 0.0 < cut.precision < math.inf
    assert cut.count == 1.0
    assert mut.cut_rating(1.0, 1.0, below=False, mean=0.0, deviation=0.01, noise=0.01) == mut.CutRating()


def test_a_rating_on_its_limit_far_from_what_was_believed_tells_the_noise_what_an_exact_one_would():
    cut = mut.cut_rating(1.0, 0.0, below=True, mean=0.3, deviation=1e-6, noise=0.02)
    assert cut.count == 1.0
    assert cut.squares + cut.precision * (0.3 - cut.mean) ** 2 == pytest.approx(0.3**2, rel=0.02)
