"""Timing of chirps: the numbers of a waveform, and what differs between two."""

from dataclasses import replace

import pytest

from radhar_cli.radar.fmcw_timing import FmcwTiming
from radhar_cli.radar.waveform import Waveform

TIMING = FmcwTiming(77e9, 1.2e9, 5e6, 128, 800.0)


def test_the_waveform_of_a_timing_has_its_timing() -> None:
    waveform = TIMING.waveform(2.0, fft_length=256, centred=False)
    assert waveform.n_adc == TIMING.samples
    assert waveform.n_pulses == 1600
    assert waveform.slope == pytest.approx(1.2e9 * 5e6 / 128)
    assert FmcwTiming.of_waveform(waveform) == TIMING


def test_bandwidth_is_that_of_the_samples_where_a_chirp_is_longer() -> None:
    waveform = Waveform(77e9, 1e9, 40.25e-6, 1e6, 800.0, 1.0)
    timing = FmcwTiming.of_waveform(waveform)
    assert timing.samples == 40
    assert timing.bandwidth_hz == pytest.approx(1e9 * 40 / 40.25)


@pytest.mark.parametrize("name", ["carrier_hz", "bandwidth_hz", "adc_rate_hz", "samples", "prf_hz"])
def test_the_first_number_that_differs_is_named(name: str) -> None:
    assert TIMING.first_difference(replace(TIMING, **{name: 2 * getattr(TIMING, name)})) == name
    assert TIMING.first_difference(replace(TIMING, carrier_hz=77e9 * (1 + 1e-7))) is None
