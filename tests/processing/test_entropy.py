"""Entropy of a power map, in bits."""

from math import log2

import numpy as np
import pytest
from helpers import reference as ref

from radhar_cli.processing.entropy import entropy_bits


@pytest.mark.parametrize("shape", [(1, 1), (2, 1), (256, 90), (7, 13)])
def test_a_uniform_map_has_the_logarithm_of_its_size(shape):
    assert entropy_bits(np.full(shape, 3.7)) == pytest.approx(log2(np.prod(shape)), abs=1e-11)


def test_a_single_pixel_has_entropy_0():
    power = np.zeros((20, 30))
    power[3, 4] = 1e-9
    assert entropy_bits(power) == 0


@pytest.mark.parametrize("pixels", [2, 3, 8])
def test_zero_pixels_do_not_count(pixels):
    power = np.zeros(100)
    power[:pixels] = 5
    assert entropy_bits(power.reshape(10, 10)) == pytest.approx(log2(pixels), abs=1e-12)


def test_a_map_of_zeros_has_entropy_0():
    assert entropy_bits(np.zeros((4, 5))) == 0


def test_known_value():
    assert entropy_bits(np.array([[0.5, 0.25], [0.125, 0.125]])) == pytest.approx(1.75, abs=1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_matches_the_definition(seed):
    """Powers over sixteen decades."""
    power = 10 ** np.random.default_rng(seed).uniform(-16, 0, (40, 30))
    assert entropy_bits(power) == pytest.approx(ref.entropy_bits(power), rel=1e-12)


def test_denormal_maps_count():
    tiny = 5e-324
    assert entropy_bits(np.array([[tiny, tiny], [0.0, 2 * tiny]])) == pytest.approx(1.5)


def test_it_is_never_negative():
    """A spike on a floor that rounds away."""
    power = np.full((50, 50), 1e-20)
    power[7, 7] = 1
    assert 0 <= entropy_bits(power) < 1e-12


def test_order_and_layout_do_not_matter():
    power = np.random.default_rng(0).exponential(size=(40, 30))
    assert entropy_bits(power[::-1].T) == pytest.approx(entropy_bits(power), rel=1e-13)
