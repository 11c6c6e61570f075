"""Distances of signals and images."""

from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.tradeoff.measures import image_scores, relative_db


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


class TestImages:
    image = rng().integers(0, 256, (32, 40)).astype(np.uint8)

    def test_the_same(self):
        assert image_scores(self.image, self.image) == (pytest.approx(1), 0)

    def test_one_level_everywhere(self):
        found = np.where(self.image < 255, self.image + 1, 254).astype(np.uint8)
        ssim, changed = image_scores(found, self.image)
        assert changed == 1
        assert 0.99 < ssim < 1

    def test_noise_is_nothing_like_it(self):
        other = np.random.default_rng(8).integers(0, 256, self.image.shape).astype(np.uint8)
        assert abs(image_scores(other, self.image)[0]) < 0.1

    @pytest.mark.parametrize(
        ("size", "ssim"), [((7, 9), 1.0), ((6, 6), 1.0), ((3, 100), 1.0), ((2, 9), None)]
    )
    def test_small_images(self, size, ssim):
        image = rng().integers(0, 256, size).astype(np.uint8)
        assert image_scores(image, image)[0] == pytest.approx(ssim)
