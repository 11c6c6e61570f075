"""Power map to grey levels."""

import numpy as np
import pytest
from PIL import Image

from radhar_cli.processing import image
from radhar_cli.processing.image import decibels, reduced

RANGE_DB = 50.0


def levels(power: np.ndarray, size: tuple[int, int], dynamic_range_db: float) -> np.ndarray:
    """Levels [H, W] of a whole map."""
    return image.levels(image.reduced_map(power, size).cells, dynamic_range_db)


def random_map(shape: tuple[int, int]) -> np.ndarray:
    return 10 ** np.random.default_rng(0).uniform(-7, 0, shape)


@pytest.mark.parametrize("shape", [(1, 1), (51, 93), (2000, 90)])
def test_a_map_of_zeros_is_black(shape):
    found = levels(np.zeros(shape), (64, 32), RANGE_DB)
    assert found.dtype == np.uint8
    assert found.shape == (64, 32)
    assert not found.any()


@pytest.mark.parametrize(("row", "column"), [(0, 0), (0, 9), (3, 2), (7, 0), (7, 9)])
def test_a_single_bright_pixel_and_which_way_is_up(row, column):
    """Row 0 of a map is the lowest frequency, and the bottom of its image."""
    power = np.zeros((8, 10))
    power[row, column] = 1e-7
    right = np.zeros((8, 10))
    right[7 - row, column] = 255
    assert np.array_equal(levels(power, (8, 10), RANGE_DB), right)


@pytest.mark.parametrize("dynamic_range_db", [10.0, 50.0, 120.0])
def test_decibels_become_levels(dynamic_range_db):
    """0 dB is 255, the end of the range 0, all below clipped; between them to the nearest."""
    decibels = np.array([0, -1.3, -9.99, -10.01, -37, -49.99, -50.01, -119, -121, -200.0])
    found = levels(10 ** (decibels[None] / 10), (1, 10), dynamic_range_db)[0]
    exact = 255 * np.clip(1 + decibels / dynamic_range_db, 0, 1)
    assert np.abs(found - exact).max() <= 0.5 + 1e-3


def test_one_decibel_a_level():
    """A range of 255 dB shows where the rounding is: to the nearest, for every level."""
    level = np.arange(1, 256)
    for offset in (-0.45, 0.0, 0.45):
        decibels = np.minimum(level + offset, 255) - 255
        power = 10 ** (decibels[None] / 10)
        assert np.array_equal(levels(power, (1, 255), 255.0)[0], level)


@pytest.mark.parametrize("scale", [2.0**-1000, 2.0**-3, 2.0**900])
def test_a_power_of_two_changes_nothing(scale):
    power = random_map((70, 40))
    found = levels(power * scale, (32, 32), RANGE_DB)
    assert np.array_equal(found, levels(power, (32, 32), RANGE_DB))


def test_denormal_maps_are_images_too():
    power = np.zeros((8, 8))
    power[2, 3], power[4, 4] = 5e-320, 5e-324
    found = levels(power, (8, 8), RANGE_DB)
    assert found[5, 3] == 255
    assert found[3, 4] == round(255 * (1 - 4 / 5))


def test_power_is_resized_and_not_its_logarithm():
    """A ridge of one bin, halved in height, loses 4 dB of 50: it would lose 31 as levels.

    The triangle of Pillow's antialiasing gives a row 3/8 of itself.
    """
    power = np.zeros((64, 16))
    power[10:20] = 1.0
    power[40] = 1.0
    found = levels(power, (32, 16), RANGE_DB)[::-1]
    assert (found[6:9] == 255).all()
    assert (found[20] == round(255 * (1 + 10 * np.log10(3 / 8) / RANGE_DB))).all()


def test_the_new_maximum_is_white():
    """Normalised after resizing: a lone pixel is white however much the resizing dims it."""
    power = np.zeros((500, 300))
    power[123, 200] = 1
    found = levels(power, (50, 30), RANGE_DB)
    assert found.max() == 255
    assert np.unravel_index(found.argmax(), found.shape) == (49 - 12, 20)


@pytest.mark.parametrize("size", [(16, 48), (7, 5), (300, 2)])
def test_height_comes_first(size):
    found = levels(random_map((30, 20)), size, RANGE_DB)
    assert found.shape == size
    assert found.max() == 255


def test_the_input_is_not_modified_in_any_layout():
    power = random_map((30, 20))
    kept = power.copy()
    plain = levels(power, (16, 16), RANGE_DB)
    assert np.array_equal(levels(np.asfortranarray(power), (16, 16), RANGE_DB), plain)
    assert np.array_equal(power, kept)


@pytest.mark.parametrize("size", [(256, 256), (64, 300), (300, 16), (7, 5)])
@pytest.mark.parametrize("shape", [(2000, 90), (51, 700), (101, 20), (3, 2), (1, 1), (256, 256)])
def test_resizing_is_pillows(shape, size):
    """BILINEAR with antialiasing: the definition that docs/physics/model.md gives."""
    power = np.random.default_rng(0).exponential(size=shape)
    picture = Image.fromarray(power[::-1].astype(np.float32))
    right = np.asarray(picture.resize(size[::-1], Image.Resampling.BILINEAR))
    for dtype, rounding in ((np.float64, 2e-7), (np.float32, 1e-6)):
        found = reduced([power.T.astype(dtype)], shape[1], size).cells
        assert np.abs(found / right - 1).max() < rounding


def test_size_of_bands_does_not_matter(monkeypatch):
    power = np.random.default_rng(0).exponential(size=(700, 300))
    right = reduced([power.T], 300, (64, 64)).cells
    monkeypatch.setattr(image, "BAND", 5)
    assert reduced([power.T], 300, (64, 64)).cells == pytest.approx(right, rel=1e-6)


def test_decibels_below_the_largest():
    power = np.array([[1e-3, 2e-3], [0.0, 2e-9]])
    right = [[-10 * np.log10(2), 0], [-50, -50]]
    assert decibels(power, 50.0) == pytest.approx(np.array(right), abs=1e-12)
    assert np.array_equal(decibels(np.zeros((2, 3)), 40.0), np.full((2, 3), -40.0))


@pytest.mark.parametrize("span", [(0.0, 40.0), (3.0, 17.0), (0.5, 12.5), (10.25, 11.75)], ids=str)
@pytest.mark.parametrize("height", [7, 40, 256])
def test_rows_of_a_span_are_those_of_pillow(span, height):
    """Row r has its centre (r + 1/2)/height of the way through the span, wherever that begins."""
    power = random_map((40, 9))
    picture = Image.fromarray(power.astype(np.float32))
    box = (0, span[0], 9, span[1])
    expected = np.asarray(picture.resize((9, height), Image.Resampling.BILINEAR, box=box))
    found = image.reduced_map(power, (height, 9), rows=span)
    scale = 2.0 ** image.binary_exponent(power)
    assert found.cells[::-1] * scale == pytest.approx(expected, rel=1e-4, abs=1e-6)


def test_a_ramp_over_a_span_reads_the_centres_of_rows():
    """Interpolation is linear: a map whose value is its row has in every row that row's place."""
    ramp = np.arange(64.0)[:, None] + np.zeros(3)
    span, height = (12.3, 40.7), 100
    found = image.reduced_map(ramp, (height, 3), rows=span).cells[::-1, 0]
    centres = span[0] + (np.arange(height) + 0.5) * (span[1] - span[0]) / height
    scale = 2.0 ** image.binary_exponent(ramp)
    assert found * scale == pytest.approx(centres - 0.5, abs=1e-4)


def test_a_span_of_a_map_that_comes_in_many_bands_is_the_same():
    power = random_map((1000, 5))
    scaled = [np.ldexp(power.T, -image.binary_exponent(power))]
    part = reduced(scaled, 5, (50, 5), rows=(300.0, 500.0)).cells
    near = reduced([scaled[0][:, 290:510]], 5, (50, 5), rows=(10.0, 210.0)).cells
    assert part == pytest.approx(near, rel=1e-6)
