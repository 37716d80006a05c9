"""Points of the posterior distribution of weights on the simplex, by a random walk along the simplex's edges.

Along the direction in which weight i grows at the expense of weight j the posterior is

    p(t) proportional to (b + (RSS_0 + q (t - t_0)^2) / 2)^-(a + n / 2),    -w_i <= t <= w_j,

and a slice sampler draws from it exactly (R. Neal, "Slice Sampling", 2003): with u uniform in (0, 1), t is uniform
where p(t) >= u p(0), which is an interval. Ratings tell of each weight by itself, so that only their sum couples them:
some of the ten edges always lead along what is vague, and the walk forgets where it began within a few rounds, however
sharp some weights are known and however near the simplex's faces they lie.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt

from mala_drake.learning.rating_evidence import Evidence
from mala_drake.preferences import CRITERIA

FloatArray = npt.NDArray[np.float64]

_EDGES = tuple(combinations(range(len(CRITERIA)), 2))
_ROUNDS = 40  # Over all edges.
_LEAST_SQUARES = 1e-300  # Keeps an interval from being empty where ratings are met exactly.


def walk_on_simplex(evidence: Evidence, start: FloatArray) -> FloatArray:
    """One point of the posterior for each point that a walk starts from.

    The underlying random numbers are always the same.

    Args:
        evidence: what has been rated.
        start: (k, 5), on the simplex; not modified.

    Returns:
        (k, 5), on the simplex.
    """
    generator = np.random.Generator(np.random.PCG64(21))
    points = start.copy()
    root = -1.0 / (evidence.noise_shape + 0.5 * evidence.count)
    for _ in range(_ROUNDS):
        for i, j in _EDGES:
            level, place = generator.random((2, len(points)))
            lower, upper = _slice(evidence, points, (i, j), np.power(1.0 - level, root))
            step = lower + place * (upper - lower)
            total = points[:, i] + points[:, j]
            points[:, i] = np.clip(points[:, i] + step, 0.0, total)
            points[:, j] = total - points[:, i]
    return points


def _slice(
    evidence: Evidence, points: FloatArray, edge: tuple[int, int], growth: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Where along an edge 2 b + RSS is at most `growth` times what it is at the points: ends of t, (k,) each."""
    (i, j), information, moment = edge, evidence.information, evidence.moment
    first, second = points[:, i], points[:, j]
    here = 2.0 * evidence.noise_scale + np.maximum(evidence.residual_squares(points), 0.0)
    curvature = information[i] + information[j]
    if not curvature > 0.0:
        return -first, second
    centre = (moment[i] - information[i] * first - moment[j] + information[j] * second) / curvature
    least = here - curvature * centre**2
    half = np.sqrt(np.maximum(growth * here - least, _LEAST_SQUARES) / curvature)
    return np.maximum(-first, centre - half), np.minimum(second, centre + half)
