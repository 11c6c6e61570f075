"""Derived numbers of an FMCW waveform."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config
from radhar_cli.config.identity import resolved
from radhar_cli.config.reading import validated
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.bodies.motion_paths import MotionPaths
from radhar_cli.errors import ConfigError
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.scene.radar import waveform_of
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.scene.single.simulate import simulate

# The paper's table "Experimental Parameter Settings".
FREE_SPACE = Waveform(fc=77e9, bandwidth=4e9, chirp=40e-6, adc_rate=10e6, prf=5000.0, duration=4.0)
THROUGH_WALL = replace(FREE_SPACE, fc=2e9, bandwidth=1e9, prf=128.0)


def test_sample_and_pulse_counts_of_the_paper() -> None:
    assert (FREE_SPACE.n_adc, FREE_SPACE.n_pulses) == (400, 20_000)
    assert (THROUGH_WALL.n_adc, THROUGH_WALL.n_pulses) == (400, 512)
    assert (FREE_SPACE.n_fft, FREE_SPACE.n_bins) == (400, 200)


@pytest.mark.parametrize(
    ("waveform", "step", "half_band"), [(FREE_SPACE, 0.037, 7.49), (THROUGH_WALL, 0.15, 29.98)]
)
def test_ranges_of_the_paper(waveform: Waveform, step: float, half_band: float) -> None:
    assert waveform.slope == pytest.approx(waveform.bandwidth / 40e-6, rel=1e-15)
    assert waveform.half_band_range == pytest.approx(half_band, abs=0.005)
    assert waveform.range_step == pytest.approx(step, abs=0.0005)
    # With N_FFT = N_ADC = fs Tp the step is the range resolution c/(2 B).
    resolution = SPEED_OF_LIGHT / (2 * waveform.bandwidth)
    assert waveform.range_step == pytest.approx(resolution, rel=1e-14)


@pytest.mark.parametrize(("waveform", "speed"), [(FREE_SPACE, 4.9), (THROUGH_WALL, 4.8)])
def test_the_doppler_of_the_start_of_the_chirp_aliases_as_in_the_paper(
    waveform: Waveform, speed: float
) -> None:
    at_start = replace(waveform, centred=False)
    assert (at_start.n0, at_start.f0) == (0, waveform.fc)
    assert at_start.highest_speed == pytest.approx(speed, abs=0.05)


@pytest.mark.parametrize("waveform", [FREE_SPACE, THROUGH_WALL])
def test_at_mid_chirp_the_doppler_is_that_of_the_mid_frequency(waveform: Waveform) -> None:
    assert waveform.n0 == 200
    assert waveform.f0 == pytest.approx(waveform.fc + waveform.bandwidth / 2, rel=1e-15)
    # A target at the highest speed shifts by PRF/2: 2 v f0/c.
    doppler = 2 * waveform.highest_speed * waveform.f0 / SPEED_OF_LIGHT
    assert doppler == pytest.approx(waveform.prf / 2, rel=1e-14)


def test_wavelength_is_that_of_the_carrier() -> None:
    assert THROUGH_WALL.wavelength == pytest.approx(0.149896229, rel=1e-15)


@pytest.mark.parametrize(("rate", "n_adc", "n_fft"), [(10e6, 400, 400), (10.02e6, 401, 402)])
def test_the_fft_is_even_and_holds_the_chirp(rate: float, n_adc: int, n_fft: int) -> None:
    waveform = replace(FREE_SPACE, adc_rate=rate)
    assert (waveform.n_adc, waveform.n_fft) == (n_adc, n_fft)
    assert waveform.n0 == n_adc / 2


@given(st.integers(200, 2000).map(lambda half: 2 * half))
@settings(deadline=None, max_examples=30)
def test_range_bins_fill_the_half_band_whatever_the_fft_length(length: int) -> None:
    waveform = replace(FREE_SPACE, fft_length=length)
    axis = waveform.range_axis()
    assert (waveform.n_fft, axis.size) == (length, length // 2)
    assert axis[0] == 0
    np.testing.assert_allclose(np.diff(axis), waveform.range_step, rtol=1e-9)
    assert axis[-1] + waveform.range_step == pytest.approx(waveform.half_band_range, rel=1e-14)


def test_a_bin_is_the_range_whose_beat_it_is() -> None:
    """R_k = c f_b/(2 K) at the beat frequency f_b = k fs/N_FFT."""
    beat = np.arange(200) * 10e6 / 400
    expected = SPEED_OF_LIGHT * beat / (2 * 1e14)
    np.testing.assert_allclose(FREE_SPACE.range_axis(), expected, rtol=1e-14)


def test_pulses_are_a_pulse_interval_apart() -> None:
    np.testing.assert_allclose(THROUGH_WALL.times(np.array([0.0, 1.0, 64.0])), [0, 1 / 128, 0.5])


@pytest.mark.parametrize(
    ("duration", "prf", "pulses"),
    [(0.1, 15.0, 2), (1.45, 10.0, 15), (1.005, 100.0, 101), (0.4999, 1.0, 0)],
)
def test_counts_are_rounded_half_up_as_written(duration: float, prf: float, pulses: int) -> None:
    assert replace(FREE_SPACE, duration=duration, prf=prf).n_pulses == pulses


STEPS = {"carrier_hz": 1e9, "bandwidth_hz": 2e9, "prf_hz": 100}


BASE_OF_STEPS = {
    "motion": {"range_m": 6},
    "duration_s": 1,
    "activities": ["walking"],
    "maps": ["stft", "rtm"],
}


def stepped(**more: object) -> Config:
    return Config.model_validate(BASE_OF_STEPS | {"radar": STEPS | more})


def test_stepped_frequencies_are_the_chirp_of_the_same_samples() -> None:
    """Bit for bit, and at the frequencies carrier + n B/N."""
    steps, chirp = (
        simulate(config, "walking", index=1)
        for config in (
            stepped(waveform="sfcw", steps=200, dwell_s=4e-5),
            stepped(adc_rate_hz=1 / 4e-5, chirp_s=200 * 4e-5),
        )
    )
    assert steps.waveform == chirp.waveform
    assert steps.waveform.n_adc == 200
    assert steps.waveform.slope / steps.waveform.adc_rate == pytest.approx(2e9 / 200, rel=1e-12)
    np.testing.assert_array_equal(steps.signals["raw"].x, chirp.signals["raw"].x)
    np.testing.assert_array_equal(steps.maps["rtm"].power, chirp.maps["rtm"].power)
    again = replace(steps.scene, config=Config.model_validate(resolved(steps.config)))
    assert waveform_of(again) == steps.waveform


def test_samples_of_stepped_frequencies() -> None:
    """S(f) = sum A exp(-j 2 pi f tau), against numbers of another implementation."""
    config = stepped(waveform="sfcw", steps=16, dwell_s=1e-4)
    scene = nominal_scene(config, config.chosen_activities[0])
    delay, amplitude = np.array([[2e-8], [5e-8]]), np.array([[1.0], [0.5]])
    found = beat_matrix(delay, amplitude, waveform_of(scene))[:, 0]
    right = np.tile([1.5, -1 - 0.5j, 0.5, -1 + 0.5j], 4)
    np.testing.assert_allclose(found, right, atol=1e-12)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            {"waveform": "sfcw", "steps": 8},
            r"radar\.dwell_s.*is required with radar\.waveform: sfcw",
        ),
        ({"steps": 8}, r"radar\.steps.*a key of radar\.waveform: sfcw"),
        (
            {"waveform": "sfcw", "steps": 8, "dwell_s": 1e-4, "chirp_s": 1e-5},
            r"radar\.chirp_s.*is unknown with",
        ),
        ({"waveform": "sfcw", "steps": 8, "dwell_s": 2e-3}, r"radar\.steps.*is 0\.016 s"),
    ],
)
def test_steps_that_do_not_fit(more: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        validated(Config, {**BASE_OF_STEPS, "radar": STEPS | more}, "here", {})


def test_a_slow_sweep_and_a_short_fft_are_told_by_their_own_keys() -> None:
    document = {"radar": STEPS | {"waveform": "sfcw", "steps": 8, "dwell_s": 2e-3}}
    with pytest.raises(ValueError, match=r"processing\.range_fft_length") as error:
        Config.model_validate(document | {"processing": {"range_fft_length": 4}})
    assert "radar.steps" in str(error.value)


CW: dict[str, Any] = {
    "radar": {"waveform": "cw", "carrier_hz": 24e9, "prf_hz": 500},
    "activities": ["walking"],
}


@pytest.mark.parametrize("kind", ["direct", "cube"])
def test_one_sample_a_pulse_without_modulation(kind: str) -> None:
    """x = sum A exp(-j 2 pi fc tau), by both engines; Doppler of fc, no range."""
    document = {"duration_s": 1, "snr_db": None, "maps": ["stft"], "engine": {"kind": kind}}
    document["processing"] = {"clutter": "none"}
    document["radar"] = CW["radar"] | {"antenna_isolation_db": 300}
    found = simulate(Config.model_validate(CW | document), nominal=True, maps=("stft",))
    w = found.waveform
    assert (w.n_adc, w.f0, w.n_bins) == (1, 24e9, 1)
    paths = MotionPaths(found.motion, found.antennas, w.fc, None)(w.times(np.arange(5.0)))
    expected = (paths.amplitude * np.exp(-2j * np.pi * w.fc * paths.delay)).sum(axis=0)
    np.testing.assert_allclose(found.signals["raw"].x[0, 0, :5], expected, rtol=1e-6)


@pytest.mark.parametrize("kind", ["direct", "cube"])
def test_the_doppler_of_real_samples_is_symmetric(kind: str) -> None:
    document: dict[str, Any] = {"duration_s": 1, "snr_db": 10, "engine": {"kind": kind}}
    radar = CW["radar"] | {"output": "real"}
    config = Config.model_validate(CW | document | {"radar": radar, "maps": ["stft"]})
    both = Config.model_validate(CW | document | {"maps": ["stft"]})
    found, complex_ = (simulate(one, nominal=True, maps=("stft",)) for one in (config, both))
    np.testing.assert_array_equal(found.signals["raw"].x, complex_.signals["raw"].x.real)
    power = found.maps["stft"].power
    odd = len(power) % 2 == 0  # -PRF/2 has no partner
    assert np.abs(power[odd:] - power[odd:][::-1]).max() < 1e-12 * power.max()


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"maps": ["rtm"]}, r"maps.*should be some of stft.*cw has no range"),
        ({"processing": {"range_sum": "gated"}}, r"range_sum.*coherent with radar.waveform: cw"),
        (
            {"radar": {**CW["radar"], "output": "real"}, "maps": ["stft_compensated"]},
            r"maps.*stft, stft_denoised, fsst.*radar.output: real has no sign",
        ),
        ({"radar": CW["radar"] | {"chirp_s": 1e-5}}, r"radar.chirp_s.*is unknown with"),
        ({"processing": {"range_fft_length": 64}}, r"range_fft_length.*should be left out"),
        ({"processing": {"range_reference": "start"}}, r"range_reference.*should be left out"),
        ({"radar": {"output": "real"}}, r"radar.output.*a key of radar.waveform: cw"),
    ],
)
def test_what_cw_does_not_have(more: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        validated(Config, CW | {"maps": ["stft"]} | more, "here", {})
