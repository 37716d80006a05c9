import math

import pytest

from mala_drake.errors import BadInput
from mala_drake.preferences import CRITERIA, UNIFORM_WEIGHTS, validated_weights


def test_uniform_weights_are_valid():
    assert validated_weights(UNIFORM_WEIGHTS) == UNIFORM_WEIGHTS
    assert len(CRITERIA) == 5


def test_rounding_of_decimals_is_forgiven():
    assert validated_weights([0.1, 0.2, 0.3, 0.2, 0.2000001]) == (0.1, 0.2, 0.3, 0.2, 0.2000001)


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ((0.5, 0.5), r"w: 2 weights; expected 5 \(time, safety, battery, proximity, approach\)"),
        ((), "w: 0 weights; expected 5"),
        ((0.2, 0.2, 0.2, 0.2, 0.3), r"w: the sum of the weights is 1.1; expected 1"),
        ((1.2, -0.2, 0.0, 0.0, 0.0), r"w\.safety: -0.2; expected a finite number >= 0"),
        ((0.2, 0.2, math.nan, 0.2, 0.2), r"w\.battery: nan; expected a finite number >= 0"),
        ((0.2, 0.2, 0.2, 0.2, math.inf), r"w\.approach: inf; expected a finite number >= 0"),
    ],
)
def test_weights_off_the_simplex_are_refused_in_one_line(weights, message):
    with pytest.raises(BadInput, match=f"^{message}"):
        validated_weights(weights, where="w")
