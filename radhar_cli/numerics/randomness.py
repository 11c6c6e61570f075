"""Named random streams: what a stream yields depends on its name and on nothing else.

``numpy.random.SeedSequence(seed, spawn_key=...)`` with a key made of the purpose, the class, the
index and the name, so that neither the order of work, nor the number of workers, nor the other
maps asked for can change a draw.
"""

import zlib

import numpy as np

PERSON = 1
SCENE = 2
NOISE = 3
SPLIT = 4
TRAINING = 5
ORDER = 6


def stream(seed: int, purpose: int, *key: int, name: str) -> np.random.Generator:
    """Return the generator named by (seed, purpose, key, name).

    Args:
        seed: the data set's seed, at least 0.
        purpose: PERSON, SCENE, NOISE, SPLIT, TRAINING or ORDER.
        key: key that the stream belongs to, for example (class, index).
        name: the field or the noise, for example ``motion.range_m``.
    """
    spawn_key = (purpose, len(key), *key, zlib.crc32(name.encode()))
    if all(0 <= number < 2**32 for number in (seed, *key)):
        # What SeedSequence makes of seed and key, for half of the time that it takes to do so.
        words = np.array([seed, 0, 0, 0, *spawn_key], np.uint32)
        return np.random.Generator(np.random.PCG64(np.random.SeedSequence(words)))
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=spawn_key)))
