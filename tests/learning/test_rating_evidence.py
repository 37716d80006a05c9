import math

import numpy as np
import pytest

from mala_drake.learning.rating_evidence import Evidence, Observation

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


def test_forgetting_keeps_the_noise_and_nothing_else():
    generator = np.random.Generator(np.random.PCG64(5))
    truth, noise = np.array([0.4, 0.3, 0.1, 0.1, 0.1]), 0.03
    features = generator.uniform(0.2, 0.9, (200, 5))
    evidence = evidence_of(features, features * truth + noise * generator.standard_normal((200, 5)))
    forgotten = evidence.forgotten(truth)
    assert forgotten.count == 0.0
    assert not forgotten.information.any()
    assert math.sqrt(forgotten.noise_variance(np.full(5, 0.2))) == pytest.approx(noise, rel=0.05)
