"""PNG files of levels with the colour map as palette."""

import io

import numpy as np
import pytest
from matplotlib import colormaps
from PIL import Image

from radhar_cli.dataset.png import colour_table, encode_png, stored_levels


def levels() -> np.ndarray:
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


def test_few_levels_keep_their_numbers():
    """A smaller palette would renumber them."""
    two = np.full((4, 4), 7, np.uint8)
    two[0] = 200
    with Image.open(io.BytesIO(encode_png(two, colour_table("viridis"), 1))) as picture:
        assert np.array_equal(stored_levels(picture), two)
