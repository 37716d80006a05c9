"""What a rating that was cut says: only that its y lies below (or above) a limit (Tobin, 1958).

With e the noise of y = f w + e, the belief N(mean, d^2) about w and u = f (w - mean) + e of the deviation S, where
S^2 = f^2 d^2 + s^2, that y lies below the limit means u < S z. It has the probability Phi(z), and with the inverse
Mills ratio r = phi(z) / Phi(z)

    E[w | cut] = mean - (f d^2 / S) r,    Var[w | cut] = d^2 - (f d^2 / S)^2 r (r + z),
    E[e^2 | cut] = s^2 (1 - k),    k = (s / S)^2 z r.

The first two are matched by a Gaussian factor on w (assumed-density filtering). The third is what expectation
maximisation would add to the squares of the noise beside a count of 1. But a rating that was cut as was to be expected
(z >> 0) tells next to nothing about the noise and must not make it look well known. So it counts as min(1, |k|) of a
rating, with the squares that leave the noise s at rest where all of them would: s^2 (count - k).
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CutRating:
    """What is to be added to the evidence; the numbers that do nothing if the cut tells nothing.

    Attributes:
        precision: of the factor N(mean, s^2 / precision) on the weight.
        mean: of that factor.
        count: number of ratings that tell as much about the noise, in [0, 1].
        squares: to be added to the factor's own residual, so that together they are the expected one.
    """

    precision: float = 0.0
    mean: float = 0.0
    count: float = 0.0
    squares: float = 0.0


def cut_rating(feature: float, limit: float, *, below: bool, mean: float, deviation: float, noise: float) -> CutRating:
    """What a cut rating says, given what is believed.

    Args:
        feature: f of the criterion.
        limit: of y: 0 for a rating cut to 5, 1 for one cut to 1.
        below: whether y lies below the limit.
        mean: of the weight.
        deviation: d of the weight, > 0.
        noise: s, > 0.
    """
    sign = 1.0 if below else -1.0
    spread = math.hypot(feature * deviation, noise)
    z = sign * (limit - feature * mean) / spread
    probability = 0.5 * math.erfc(-z / math.sqrt(2.0))
    if not probability > 1e-200:
        return CutRating()  # As good as impossible: a moment match would be numerically empty.
    ratio = math.exp(-0.5 * z * z) / math.sqrt(math.tau) / probability
    gain = feature * deviation**2 / spread
    after = mean - sign * gain * ratio
    variance = deviation**2 - gain**2 * ratio * (ratio + z)
    surprise = (noise / spread) ** 2 * z * ratio
    count = min(1.0, abs(surprise))
    squares = noise**2 * (count - surprise)
    precision = noise**2 * (1.0 / variance - 1.0 / deviation**2) if variance > 0.0 else 0.0
    if not precision > 1e-9 * (noise / deviation) ** 2:
        return CutRating(count=count, squares=squares)
    centre = noise**2 * (after / variance - mean / deviation**2) / precision
    return CutRating(precision, centre, count, squares - precision * (after - centre) ** 2)
