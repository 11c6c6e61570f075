"""Scales of images: relative to the noise floor, to the peak, or the same for all images."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.image import noise_floor
from radhar_cli.processing.scale import DecibelScale, Reference

RANGE_DB = 50.0
NOISE = DecibelScale(RANGE_DB, Reference.NOISE)
SHAPE = (64, 80)


def noise_map(seed: int, noise_db: float = 0.0, is_blue: bool = False) -> Float:
    """Power of white noise, or of noise after a two-pulse canceller [rows, columns]."""
    power = np.random.default_rng(seed).exponential(size=SHAPE) * 10 ** (noise_db / 10)
    rows = np.arange(-SHAPE[0] // 2, SHAPE[0] // 2) + 0.5
    return power * np.sin(np.pi * rows / SHAPE[0])[:, None] ** 2 if is_blue else power


def add_body(power: Float, rows: int, peak_db: float) -> Float:
    """Add a band of rows in the middle, as of limbs that swing, with a peak in dB."""
    middle = SHAPE[0] // 2
    band = slice(middle - rows // 2, middle + rows - rows // 2)
    swing = np.sin(np.linspace(0, 20, SHAPE[1])) ** 2 * np.linspace(0.01, 1, rows)[:, None]
    body = power.copy()
    body[band] += 10 ** (peak_db / 10) * swing
    return body


@pytest.mark.parametrize("is_blue", [False, True])
@given(
    seed=st.integers(0, 10**6),
    noise_db=st.floats(-200, 100),
    rows=st.integers(1, 32),
    peak_db=st.floats(0, 80),
)
def test_floor_is_that_of_the_noise_whoever_moves(
    is_blue: bool, seed: int, noise_db: float, rows: int, peak_db: float
) -> None:
    """A body in half of the rows moves it by 4 dB at most; a peak moves by its 80 dB.

    Of 18,000 draws with noise after a canceller none was farther off than 3.2 dB, and 5.0 dB where
    the body is as faint as the noise and fills the trough of the canceller.
    """
    empty = noise_map(seed, noise_db, is_blue)
    floor_db = 10 * np.log10(noise_floor(add_body(empty, rows, noise_db + peak_db)))
    assert floor_db == pytest.approx(
        noise_db + 10 * np.log10(np.log(2)), abs=4 if peak_db > 4 else 6
    )


@given(seed=st.integers(0, 10**6), stronger_db=st.floats(0, 20))
def test_levels_of_noise_are_the_same_beside_a_faint_and_a_strong_body(
    seed: int, stronger_db: float
) -> None:
    """Outer rows have nobody; their mean level follows the peak by 5 levels a dB otherwise."""
    empty = noise_map(seed)
    faint, strong = (add_body(empty, 8, 8 + more) for more in (0.0, stronger_db))
    outer = [NOISE.levels(power)[:10].astype(float).mean() for power in (faint, strong)]
    assert outer[0] == pytest.approx(outer[1], abs=5.0)


def test_levels_are_decibels_from_two_fifths_of_the_range_below_the_floor_on() -> None:
    power = np.ones(SHAPE)
    power[3, :4] = 10**-3.0, 10**-1.0, 10**1.0, 10**3.0
    grey = NOISE.levels(power)
    assert grey[0, 0] == 102
    assert grey[3, :4].tolist() == pytest.approx([0, 51, 153, 255], abs=0.5)


@pytest.mark.parametrize("noise", [0.0, 1e-12])
def test_nothing_is_saturated_where_noise_is_faint_or_none(noise: float) -> None:
    power = noise_map(1) * noise + noise
    power[10, 5:9] = 1.0, 0.5, 0.1, 0.01
    peak = DecibelScale(RANGE_DB).levels(power)
    assert np.array_equal(NOISE.levels(power), peak)


def test_map_of_zeros_is_black() -> None:
    for reference in (Reference.PEAK, Reference.NOISE, -60.0):
        assert not DecibelScale(RANGE_DB, reference).levels(np.zeros(SHAPE)).any()


def test_floor_of_a_map_with_empty_rows_is_zero() -> None:
    power = noise_map(2)
    power[: SHAPE[0] // 2] = 0
    assert noise_floor(power) == 0.0


@pytest.mark.parametrize("exponent", [0, -60, 40])
def test_absolute_reference_is_one_power_for_all_maps(exponent: int) -> None:
    """Cells come in units of 2^exponent; what is beyond the reference is white."""
    power = 10 ** (np.array([[-40.0, -60.0, -70.0, -200.0]]) / 10)
    scale = DecibelScale(RANGE_DB, -60.0)
    grey = scale.levels(np.ldexp(power, -exponent), exponent)[0]
    assert grey.tolist() == [255, 255, 204, 0]


@pytest.mark.parametrize("reference", [-300.0, 100.0])
@pytest.mark.parametrize("exponent", [-1000, 1000])
def test_extreme_references_give_levels(reference: float, exponent: int) -> None:
    cells = np.float32([[0.5, 1e-20, 0.0]])
    assert DecibelScale(RANGE_DB, reference).levels(cells, exponent).dtype == np.uint8


def test_floor_of_frames_is_one_for_all() -> None:
    frames = np.stack([noise_map(seed, 10) for seed in range(4)])
    assert 10 * np.log10(noise_floor(frames) / np.log(2)) == pytest.approx(10, abs=1)
