"""Distances of signals, power maps and images."""

from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.tradeoff.measures import image_scores, map_error_db, relative_db


def rng():
    """The same numbers for every test, whatever ran before it."""
    return np.random.default_rng(3)


class TestSignals:
    @given(st.floats(-150, 20))
    def test_error_is_relative_to_the_right_one(self, db):
        real, imaginary, error = rng().standard_normal((3, 200))
        right, error = real + 1j * imaginary, 1j * error
        error *= 10 ** (db / 20) * np.linalg.norm(right) / np.linalg.norm(error)
        assert relative_db(right + error, right) == pytest.approx(db, abs=0.01)

    def test_the_same_and_nothing(self):
        right = np.ones(4, dtype=complex)
        assert relative_db(right, right) == -inf
        assert relative_db(np.zeros(4, complex), np.zeros(4, complex)) is None


class TestMaps:
    def test_a_factor_changes_nothing(self):
        power = rng().random((20, 30))
        assert map_error_db(7 * power, power, 50) == pytest.approx(0, abs=1e-12)

    def test_one_cell_of_two_that_show(self):
        """0 dB and -10 dB against -13 dB: the cells at the floor do not count."""
        right, found = np.full((4, 4), 1e-9), np.full((4, 4), 1e-9)
        right[0, 0] = found[0, 0] = 1
        right[1, 1], found[1, 1] = 10**-1.0, 10**-1.3
        assert map_error_db(found, right, 50) == pytest.approx(3 / np.sqrt(2))

    def test_differences_below_the_floor_do_not_show(self):
        right, found = np.full((4, 4), 1e-9), np.full((4, 4), 1e-7)
        right[0, 0] = found[0, 0] = 1
        assert map_error_db(found, right, 50) == 0
        assert map_error_db(found, right, 80) == pytest.approx(10 * np.sqrt(15 / 16))

    def test_empty_maps(self):
        nothing = np.zeros((3, 3))
        assert map_error_db(nothing, nothing, 50) == 0
        assert map_error_db(nothing, np.zeros((3, 4)), 50) is None


class TestImages:
    image = rng().integers(0, 256, (32, 40)).astype(np.uint8)

    def test_the_same(self):
        assert image_scores(self.image, self.image) == (pytest.approx(1), None, 0)

    def test_one_level_everywhere(self):
        """A mean squared error of 1 is 20 log10 255 dB below the peak."""
        found = np.where(self.image < 255, self.image + 1, 254).astype(np.uint8)
        ssim, psnr_db, changed = image_scores(found, self.image)
        assert psnr_db == pytest.approx(48.13, abs=0.01)
        assert changed == 1
        assert 0.99 < ssim < 1

    def test_noise_is_nothing_like_it(self):
        other = np.random.default_rng(8).integers(0, 256, self.image.shape).astype(np.uint8)
        assert abs(image_scores(other, self.image)[0]) < 0.1

    def test_another_size_is_brought_to_the_reference(self):
        """A ramp survives being halved and doubled, noise does not."""
        ramp = np.tile(np.linspace(0, 255, 64).astype(np.uint8), (64, 1))
        half = ramp[::2, ::2]
        assert image_scores(half, ramp)[0] > 0.99
        noise = rng().integers(0, 256, (64, 64)).astype(np.uint8)
        assert image_scores(noise[::2, ::2], noise)[0] < 0.9

    @pytest.mark.parametrize(
        ("size", "ssim"), [((7, 9), 1.0), ((6, 6), 1.0), ((3, 100), 1.0), ((2, 9), None)]
    )
    def test_small_images(self, size, ssim):
        image = rng().integers(0, 256, size).astype(np.uint8)
        assert image_scores(image, image)[0] == pytest.approx(ssim)
