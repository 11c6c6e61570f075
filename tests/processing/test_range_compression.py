"""Range compression with the conjugate kernel, and the sum over the kept bins."""

from dataclasses import asdict

import numpy as np
import pytest
from helpers import reference as ref

from radhar_cli.processing.look import RangeSum
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.radar.fmcw import Waveform

RADARS = {
    "default": ref.Radar(adc_rate=1e6),
    "odd": ref.Radar(adc_rate=1.025e6),
    "zero-padded": ref.Radar(adc_rate=1e6, fft_length=64),
    "odd, zero-padded": ref.Radar(adc_rate=1.025e6, fft_length=100),
    "start": ref.Radar(adc_rate=1e6, centred=False),
    "odd, start": ref.Radar(adc_rate=1.025e6, centred=False),
}
radars = pytest.mark.parametrize("radar", RADARS.values(), ids=RADARS)


def waveform(radar: ref.Radar) -> Waveform:
    return Waveform(**asdict(radar))


def echo_from(metres: float, radar: ref.Radar) -> np.ndarray:
    return ref.beat_matrix(np.array([[2 * metres / ref.C]]), np.ones((1, 1)), radar)


def power_of(beat: np.ndarray, radar: ref.Radar) -> np.ndarray:
    """|S[k]|^2 of the first pulse."""
    return np.abs(range_compression(beat, waveform(radar))[:, 0]) ** 2


@radars
def test_it_is_the_conjugate_transform_referred_to_n0(radar):
    s = np.random.default_rng(0).standard_normal((radar.n_adc, 5, 2)).view(complex)[..., 0]
    right = ref.range_bins(s, radar)
    found = range_compression(s, waveform(radar))
    assert found.shape == (radar.n_fft // 2, 5)
    assert np.abs(found - right).max() < 1e-12 * np.abs(right).max()
    assert np.array_equal(range_compression(s, waveform(radar), slice(2, 5)), found[2:5])
    coherent = RangeSum(waveform(radar))(s)
    assert coherent[0] == pytest.approx(right.sum(axis=0), abs=1e-11 * radar.n_adc)


@radars
@pytest.mark.parametrize("bin_number", [0, 1, 7, 18])
def test_a_target_on_a_bin_peaks_there_with_full_gain(radar, bin_number):
    metres = bin_number * ref.C * radar.adc_rate / (2 * radar.slope * radar.n_fft)
    assert waveform(radar).range_axis()[bin_number] == pytest.approx(metres, rel=1e-14, abs=0)
    power = power_of(echo_from(metres, radar), radar)
    assert power.argmax() == bin_number
    assert power[bin_number] == pytest.approx(radar.n_adc**2, rel=1e-9)


@pytest.mark.parametrize("name", ["default", "start"])
def test_on_a_bin_nothing_leaks(name):
    """Not into its neighbours, and not into the half that is thrown away (Parseval)."""
    radar = RADARS[name]
    beat = echo_from(5 * ref.C / (2 * radar.bandwidth), radar)
    power = power_of(beat, radar)
    assert np.delete(power, 5).max() < 1e-18 * power[5]
    assert power.sum() == pytest.approx(radar.n_adc * np.sum(np.abs(beat) ** 2), rel=1e-9)


def test_a_target_between_bins_stays_in_the_half_band():
    """At worst, half-way between two bins, 4 % of the energy leaks out of the kept half."""
    radar = RADARS["default"]
    beat = echo_from(9.5 * ref.C / (2 * radar.bandwidth), radar)
    kept = power_of(beat, radar).sum()
    assert kept > 0.96 * radar.n_adc * np.sum(np.abs(beat) ** 2)


def test_the_phase_reference_does_not_change_the_range_power():
    s = echo_from(0.3, RADARS["default"]) + 0.5 * echo_from(0.41, RADARS["default"])
    centre, start = (power_of(s, RADARS[name]) for name in ("default", "start"))
    assert start == pytest.approx(centre, rel=1e-12)


def test_layout_of_the_matrix_does_not_matter():
    """Columns of a larger matrix, contiguous or not."""
    radar = RADARS["odd"]
    s = np.random.default_rng(1).standard_normal((radar.n_adc, 6, 2)).view(complex)[..., 0]
    for layout in (np.ascontiguousarray(s), np.asfortranarray(s), s[:, ::-1][:, ::-1]):
        assert np.array_equal(
            range_compression(layout, waveform(radar)), range_compression(s, waveform(radar))
        )
