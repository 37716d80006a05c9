"""The most likely point of a box: against least squares with bounds, and by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from mala_drake.learning.nearest_in_box import nearest_in_box


@st.composite
def problems(draw):
    """W, mean, lowest and highest: P is the inverse of W' W; scales differ and correlations may be strong."""
    size, seed = draw(st.integers(1, 6)), draw(st.integers(0, 2**32 - 1))
    spread, correlation = draw(st.floats(0.0, 2.0)), draw(st.floats(0.0, 2.0))
    generator = np.random.default_rng(seed)
    turned, _ = np.linalg.qr(generator.standard_normal((size, size)))
    whitening = np.diag(10.0 ** generator.uniform(-correlation, correlation, size)) @ turned
    whitening = whitening @ np.diag(10.0 ** generator.uniform(-spread, spread, size))
    mean = draw(st.floats(0.0, 5.0)) * generator.standard_normal(size)
    return whitening, mean, -generator.uniform(0.1, 1.0, size), generator.uniform(0.1, 1.0, size)


def covariance_of(whitening):
    inverse = np.linalg.inv(whitening)
    return inverse @ inverse.T


def cost(whitening, mean, x):
    return 0.5 * np.sum(np.square(whitening @ (x - mean)))


@given(problems())
def test_it_is_the_constrained_least_squares(problem):
    whitening, mean, lowest, highest = problem
    nearest = nearest_in_box(mean, covariance_of(whitening), lowest, highest)
    assert (lowest <= nearest).all()
    assert (nearest <= highest).all()
    best = lsq_linear(whitening, whitening @ mean, (lowest, highest), method="bvls", max_iter=100)
    # The other library's solution may be the worse one, by its rounding.
    assert cost(whitening, mean, nearest) <= cost(whitening, mean, best.x) * (1.0 + 1e-6) + 1e-12


@given(problems())
def test_what_is_in_the_box_stays_to_the_last_bit(problem):
    whitening, mean, lowest, highest = problem
    inside = np.clip(mean, lowest, highest)
    before = inside.copy()
    nearest = nearest_in_box(inside, covariance_of(whitening), lowest, highest)
    assert nearest.tobytes() == inside.tobytes() == before.tobytes()


def test_one_active_bound_is_an_exact_measurement():
    covariance = np.array([[4.0, -1.8, 0.0], [-1.8, 1.0, 0.3], [0.0, 0.3, 1.0]])
    mean = np.array([3.0, 0.2, 0.1])
    nearest = nearest_in_box(mean, covariance, np.full(3, -2.0), np.full(3, 2.0))
    assert nearest == pytest.approx(mean + covariance[:, 0] / 4.0 * (2.0 - 3.0))
    assert nearest[0] == 2.0


def test_a_bound_that_another_one_makes_needless_is_let_go():
    """Both entries are too large; put onto its bound, the first takes the second well into the box."""
    covariance = np.array([[1.0, 0.9], [0.9, 1.0]])
    nearest = nearest_in_box(np.array([2.0, 2.2]), covariance, np.full(2, -1.0), np.array([0.5, 1.5]))
    assert nearest == pytest.approx([0.5, 2.2 - 0.9 * 1.5])
