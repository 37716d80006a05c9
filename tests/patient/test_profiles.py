import math

import pytest

from mala_drake.errors import BadInput
from mala_drake.patient import PROFILES, profile_weights
from mala_drake.preferences import UNIFORM_WEIGHTS, validated_weights


@pytest.mark.parametrize("name", PROFILES)
def test_every_profile_lies_on_the_simplex(name):
    assert validated_weights(PROFILES[name]) == PROFILES[name]


def test_distances_from_uniform_are_the_known_ones_and_none_is_converged_at_the_start():
    distances = {name: math.dist(UNIFORM_WEIGHTS, weights) for name, weights in PROFILES.items()}
    assert distances == {
        "speed_oriented": pytest.approx(0.337, abs=6e-4),
        "safety_first": pytest.approx(0.339, abs=6e-4),
        "energy_conscious": pytest.approx(0.283, abs=6e-4),
        "comfort_focused": pytest.approx(0.234, abs=6e-4),
        "presentation_focused": pytest.approx(0.464, abs=6e-4),
    }
    assert min(distances.values()) > 0.15


def test_an_unknown_profile_is_refused_with_the_names_that_exist():
    assert profile_weights("safety_first") == PROFILES["safety_first"]
    with pytest.raises(BadInput, match=r"^--profile: 'grumpy'; expected one of speed_oriented, safety_first, "):
        profile_weights("grumpy", where="--profile")


def test_nobody_can_change_a_profile():
    with pytest.raises(TypeError):
        PROFILES["speed_oriented"] = (1.0, 0.0, 0.0, 0.0, 0.0)
