"""Random quadratic programs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from mala_drake.control.condensing import whitening
from mala_drake.control.qp import SoftBoxQp


def random_qp(seed: int, *, size: int = 12, soft: int = 10, hard: int = 3) -> SoftBoxQp:
    """A problem whose hard rows admit a point of the box."""
    generator = np.random.default_rng(seed)
    root = generator.standard_normal((size, size))
    hessian = root @ root.T + 0.1 * np.eye(size)
    rows = generator.standard_normal((soft + hard, size))
    lower, upper = -generator.uniform(0.0, 0.5, size), generator.uniform(0.0, 0.5, size)
    admitted = generator.uniform(lower, upper)
    bounds = rows @ admitted - generator.uniform(-0.1, 0.3, soft + hard) * (np.arange(soft + hard) < soft)
    prices = np.concatenate((10.0 ** generator.uniform(-1, 4, soft), np.full(hard, np.inf)))
    gradient = 5 * generator.standard_normal(size)
    return SoftBoxQp(hessian, whitening(hessian), gradient, lower, upper, rows, bounds, prices)


@pytest.fixture(scope="session")
def make_qp() -> Callable[..., SoftBoxQp]:
    return random_qp
