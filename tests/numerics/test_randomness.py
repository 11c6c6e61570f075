"""Named streams: what one yields depends on its name alone."""

from itertools import combinations
from zlib import crc32

import numpy as np
import pytest

from radhar_cli.config import Config
from radhar_cli.config.paths import numbers
from radhar_cli.numerics.randomness import NOISE, PERSON, SCENE, SPLIT, stream


def test_the_same_name_yields_the_same_numbers_whatever_was_drawn_before() -> None:
    alone = stream(1, SCENE, 7, 3, name="motion.range_m").random(5)
    stream(1, SCENE, 7, 3, name="motion.angle_deg").random(100)
    np.random.default_rng(0).random(10)
    again = stream(1, SCENE, 7, 3, name="motion.range_m").random(5)
    np.testing.assert_array_equal(alone, again)


def test_every_part_of_the_name_matters() -> None:
    names: list[tuple[int, int, tuple[int, ...], str]] = [
        (1, SCENE, (7, 3), "motion.range_m"),
        (2, SCENE, (7, 3), "motion.range_m"),
        *((1, purpose, (7, 3), "motion.range_m") for purpose in (PERSON, NOISE, SPLIT)),
        (1, SCENE, (8, 3), "motion.range_m"),
        (1, SCENE, (7, 4), "motion.range_m"),
        (1, SCENE, (3, 7), "motion.range_m"),
        (1, SCENE, (7,), "motion.range_m"),
        (1, SCENE, (7, 3, 0), "motion.range_m"),
        (1, SCENE, (), "motion.range_m"),
        (1, SCENE, (7, 3), "motion.angle_deg"),
        (1, SCENE, (7, 3), ""),
    ]
    first = [stream(seed, purpose, *key, name=n).random() for seed, purpose, key, n in names]
    assert len(set(first)) == len(names)


def test_no_two_keys_of_a_scene_share_a_stream() -> None:
    config = Config(wall={}, subject={"weight_kg": 80.0})
    keys = [key for key, _ in numbers(config)]
    for one, other in combinations(keys, 2):
        assert crc32(one.encode()) != crc32(other.encode()), (one, other)


@pytest.mark.parametrize("seed", [0, 2**63 - 1])
def test_every_seed_that_a_config_allows_works(seed: int) -> None:
    assert 0 <= stream(seed, SCENE, 0, 0, name="motion.range_m").random() < 1


def test_streams_of_neighbours_are_uncorrelated() -> None:
    count = 4000
    here, there = (
        np.array([stream(1, SCENE, 0, i + shift, name="a").random() for i in range(count)])
        for shift in (0, 1)
    )
    other = np.array([stream(1, SCENE, 0, i, name="b").random() for i in range(count)])
    # The correlation of independent draws has a standard error of 1/sqrt(count).
    assert abs(np.corrcoef(here, there)[0, 1]) < 5 / np.sqrt(count)
    assert abs(np.corrcoef(here, other)[0, 1]) < 5 / np.sqrt(count)
    assert here.mean() == pytest.approx(0.5, abs=5 * np.sqrt(1 / 12 / count))


@pytest.mark.parametrize("seed", [0, 1, 2**31 + 5, 2**32 - 1, 2**32, 2**63 - 1])
@pytest.mark.parametrize("key", [(), (0,), (3, 7, 0), (11, 2**32 - 1), (1, 2**32)])
def test_it_is_the_stream_of_a_seed_sequence(seed: int, key: tuple[int, ...]) -> None:
    """However its words are handed over."""
    spawn_key = (NOISE, len(key), *key, crc32(b"motion.range_m"))
    right = np.random.PCG64(np.random.SeedSequence(seed, spawn_key=spawn_key))
    found = stream(seed, NOISE, *key, name="motion.range_m")
    assert found.bit_generator.state == right.state
