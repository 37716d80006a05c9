import itertools

import numpy as np
import pytest

from mala_drake.errors import BadInput
from mala_drake.randomness import keyed_generator


def test_the_same_key_draws_the_same_numbers():
    np.testing.assert_array_equal(
        keyed_generator(3, 7, "patient").random(10), keyed_generator(3, 7, "patient").random(10)
    )


def test_the_key_means_the_same_in_every_process():
    # Numpy keeps the stream of PCG64 as it is, so this number changes only if the key does.
    assert keyed_generator(0, 1, "patient").bit_generator.random_raw() == 13140380015882708291


def test_seed_episode_and_name_each_make_another_stream():
    keys = list(itertools.product((0, 1, 2), (0, 1, 2), ("patient", "preference_learner", "")))
    firsts = {keyed_generator(*key).random() for key in keys}
    assert len(firsts) == len(keys)


@pytest.mark.parametrize(("seed", "episode", "where"), [(-1, 0, "seed"), (0, -1, "episode")])
def test_negative_numbers_are_refused(seed, episode, where):
    with pytest.raises(BadInput, match=f"^{where}: -1"):
        keyed_generator(seed, episode, "patient")
