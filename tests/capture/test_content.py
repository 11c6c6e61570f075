"""Numbers of what a recording holds: those of a waveform, and what differs between two."""

from dataclasses import replace

import pytest
from helpers.boards import MARS

from radhar_cli.capture.content import Beat, describe_difference
from radhar_cli.radar.fmcw import Waveform

BEAT = Beat(77e9, 1.2e9, 5e6, 128, 800.0)


def test_the_waveform_of_beat_signals_has_their_numbers() -> None:
    waveform = BEAT.waveform(2.0, fft_length=256, centred=False)
    assert waveform.n_adc == BEAT.samples
    assert waveform.n_pulses == 1600
    assert waveform.slope == pytest.approx(1.2e9 * 5e6 / 128)
    assert Beat.of_waveform(waveform) == BEAT


def test_bandwidth_is_that_of_the_samples_where_a_chirp_is_longer() -> None:
    beat = Beat.of_waveform(Waveform(77e9, 1e9, 40.25e-6, 1e6, 800.0, 1.0))
    assert beat.samples == 40
    assert beat.bandwidth_hz == pytest.approx(1e9 * 40 / 40.25)


def test_frames_have_the_numbers_of_one_transmitter() -> None:
    beat = Beat.of_frames(MARS)
    assert (beat.carrier_hz, beat.adc_rate_hz, beat.samples) == (77.7e9, 2.499e6, 80)
    assert beat.bandwidth_hz == pytest.approx(100e12 * 80 / 2.499e6)
    assert beat.prf_hz == pytest.approx(1 / (3 * 57e-6))


@pytest.mark.parametrize("name", ["carrier_hz", "bandwidth_hz", "adc_rate_hz", "samples", "prf_hz"])
def test_the_number_that_differs_is_named(name: str) -> None:
    other = replace(BEAT, **{name: 2 * getattr(BEAT, name)})
    assert str(describe_difference(other, BEAT)).startswith(f"{name} = ")
    assert describe_difference(replace(BEAT, carrier_hz=77e9 * (1 + 1e-7)), BEAT) is None
