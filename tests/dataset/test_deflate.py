"""Compression of PNG and HDF5."""

import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.dataset.png import deflated

LEVELS = [0, 1, 2, 6, 9]


@pytest.mark.parametrize("level", LEVELS)
@given(data=st.binary(max_size=2000), repeats=st.integers(1, 40))
def test_zlib_reads_it_and_equal_data_give_equal_bytes(level, data, repeats):
    data *= repeats
    stored = deflated(data, level)
    assert zlib.decompress(stored) == data
    assert deflated(data, level) == stored


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("size", [0, 1, 65_535, 65_536, 1_000_000])
def test_noise_hardly_grows(level, size):
    """A data set whose chunks are larger than this is refused as a foreign file's trick."""
    noise = np.random.default_rng(size).bytes(size)
    assert len(deflated(noise, level)) <= size + size // 1000 + 64


def test_fast_is_about_as_small():
    rng = np.random.default_rng(0)
    levels = rng.gamma(2, 12, (256, 256)).astype(np.uint8).tobytes()
    assert len(deflated(levels, 1)) < 1.1 * len(zlib.compress(levels, 1))
