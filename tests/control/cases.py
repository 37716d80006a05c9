"""What solvers are tried on."""

from __future__ import annotations

import numpy as np

from mala_drake.messages import Shape

BOX = Shape("box", 1.5, 0.25, 0.3, 0.3, 0.2, 0.05)
START = np.array([0.0, 0.0, 0.1, 0.4, 0.0, 0.0])


def random_case(seed, parameters_toward, **constraints):
    """A state near the origin, and the parameters of a target in front of it; the seed may be a generator."""
    generator = np.random.default_rng(seed)
    state = generator.uniform((-1, -1, -1, -0.3, 0, -0.5), (0, 1, 1, 1.2, 0, 0.5))
    return state, parameters_toward(tuple(generator.uniform((2, -1, -1), (4, 1, 1))), **constraints)
