"""PNG files of levels with the colour map as palette; the compression of PNG and HDF5."""

import io
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib import colormaps
from PIL import Image

from radhar_cli.dataset.png import colour_table, deflate, encode_png, stored_levels

LEVELS = [0, 1, 2, 6, 9]


def levels():
    return (
        np.random.default_rng(0)
        .permutation(np.arange(48 * 32) % 256)
        .astype(np.uint8)
        .reshape(48, 32)
    )


def test_the_stored_colour_map_is_that_of_matplotlib():
    rgb = colormaps["viridis"](np.arange(256))[:, :3]
    assert np.array_equal(colour_table("viridis"), np.floor(rgb * 255 + 0.5))


@pytest.mark.parametrize("name", ["viridis", "gray", "jet"])
@pytest.mark.parametrize("compress_level", [0, 1, 9])
def test_pixels_are_levels_and_the_palette_is_the_colour_map(name, compress_level):
    """Of all 256 levels, also those that share a colour."""
    table = colour_table(name)
    with Image.open(io.BytesIO(encode_png(levels(), table, compress_level))) as picture:
        assert picture.mode == "P"
        assert picture.size == (32, 48)
        assert np.array_equal(np.asarray(picture), levels())
        assert np.array_equal(stored_levels(picture), levels())
        assert np.array_equal(np.asarray(picture.convert("RGB")), table[levels()])


def test_indices_of_a_strange_palette_are_no_levels():
    for picture in (
        Image.fromarray(levels()),
        Image.fromarray(colour_table("jet")[levels()]).quantize(16),
    ):
        buffer = io.BytesIO()
        picture.save(buffer, "png")
        with Image.open(buffer) as again:
            assert stored_levels(again) is None


@pytest.mark.parametrize("level", LEVELS)
@given(data=st.binary(max_size=2000), repeats=st.integers(1, 40))
def test_zlib_reads_it_and_equal_data_give_equal_bytes(level, data, repeats):
    data *= repeats
    stored = deflate(data, level)
    assert zlib.decompress(stored) == data
    assert deflate(data, level) == stored


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("size", [0, 1, 65_535, 65_536, 1_000_000])
def test_noise_hardly_grows(level, size):
    """A data set whose chunks are larger than this is refused as a foreign file's trick."""
    noise = np.random.default_rng(size).bytes(size)
    assert len(deflate(noise, level)) <= size + size // 1000 + 64


def test_fast_is_about_as_small():
    rng = np.random.default_rng(0)
    levels = rng.gamma(2, 12, (256, 256)).astype(np.uint8).tobytes()
    assert len(deflate(levels, 1)) < 1.1 * len(zlib.compress(levels, 1))
