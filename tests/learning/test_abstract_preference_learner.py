import json
import math

import numpy as np
import pytest

from mala_drake.errors import BadInput
from mala_drake.learning import ProjectedGradient
from mala_drake.learning.abstract_preference_learner import rated


def test_only_finite_ratings_of_finite_features_count():
    ratings, features, mask = rated((4.0, None, 3.0, math.nan, 2.0), (0.5, 0.5, math.nan, 0.5, 0.1))
    np.testing.assert_array_equal(mask, [True, False, False, False, True])
    np.testing.assert_array_equal(ratings, [4.0, 0.0, 0.0, 0.0, 2.0])
    np.testing.assert_array_equal(features, [0.5, 0.0, 0.0, 0.0, 0.1])


def test_no_ratings_at_all_are_five_missing_ones():
    _, _, mask = rated((), (0.5,) * 5)
    np.testing.assert_array_equal(mask, np.zeros(5, dtype=bool))


def test_a_state_survives_json_bit_for_bit():
    learner = ProjectedGradient()
    state = learner.update(
        learner.initial_state(), ratings=(4.1, 3.3, 4.7, 2.9, 4.0), features=(0.3, 0.9, 0.4, 0.7, 0.1)
    )
    restored = learner.restore(json.loads(json.dumps(learner.save(state))))
    assert restored.tobytes() == state.tobytes()


@pytest.mark.parametrize(
    ("saved", "where"),
    [
        ({}, "checkpoint.learner"),
        ({"learner": "Oracle", "state": [0.2] * 6}, "checkpoint.learner"),
        ({"learner": "ProjectedGradient"}, "checkpoint.state"),
        ({"learner": "ProjectedGradient", "state": [0.2] * 5}, "checkpoint.state"),
        ({"learner": "ProjectedGradient", "state": ["much"] * 6}, "checkpoint.state"),
        ({"learner": "ProjectedGradient", "state": [0.2] * 5 + [math.nan]}, "checkpoint.state"),
    ],
)
def test_a_checkpoint_that_is_not_one_is_refused(saved, where):
    with pytest.raises(BadInput) as error:
        ProjectedGradient().restore(saved)
    assert error.value.where == where
