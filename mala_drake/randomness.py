"""Random generators that depend on nothing but the seed, the episode and the system's name."""

from __future__ import annotations

import zlib

import numpy as np

from mala_drake.errors import BadInput


def keyed_generator(seed: int, episode: int, name: str) -> np.random.Generator:
    """The random generator of the system `name` in the episode `episode` of a run with the seed `seed`.

    No generator outlives its episode, so a run resumed at any episode draws what the uninterrupted run would have
    drawn, and systems do not disturb each other's streams. The name enters by its CRC-32, which unlike `hash` is the
    same in every process.

    Args:
        seed: of the run, >= 0.
        episode: counted over the whole run, >= 0.
        name: of the system, for example "patient".

    Raises:
        BadInput: if the seed or the episode is negative.
    """
    for label, number in (("seed", seed), ("episode", episode)):
        if number < 0:
            raise BadInput(label, str(number), "an integer >= 0")
    key = np.random.SeedSequence((seed, episode, zlib.crc32(name.encode())))
    # Named rather than left to `default_rng`, because the default may change with numpy's version.
    return np.random.Generator(np.random.PCG64(key))
