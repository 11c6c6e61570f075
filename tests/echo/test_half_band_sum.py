"""The sum over the kept range bins: its table, and where in the chirp it reads the Doppler."""

from dataclasses import asdict

import numpy as np
import pytest
from helpers import reference as ref
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal.windows import blackmanharris

from radhar_cli.echo import half_band_sum as hbs
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.processing.look import RangeSum, noise_gain, weights
from radhar_cli.radar.chirp_window import ChirpWindow
from radhar_cli.radar.fmcw import Waveform

RADARS = {
    "centre": ref.Radar(),
    "start": ref.Radar(centred=False),
    "odd": ref.Radar(adc_rate=1.025e6),  # 41 samples: n0 = 20.5, N_FFT = 42
    "odd, start": ref.Radar(adc_rate=1.025e6, centred=False),
    "zero-padded": ref.Radar(adc_rate=1e6, fft_length=128),
    "odd, zero-padded": ref.Radar(adc_rate=1.025e6, fft_length=64),
    "two samples": ref.Radar(adc_rate=5e4),
}
radars = pytest.mark.parametrize("radar", RADARS.values(), ids=RADARS)

# Beat frequencies of several periods, both signs, and both sides of every seam between periods.
U = np.concatenate(
    [
        np.random.default_rng(1).uniform(-2.5, 2.5, 2000),
        *(seam + np.array([-1e-6, 0, 1e-6]) for seam in range(-2, 4)),
    ]
)
ROUNDING = 1e-12


def waveform(radar: ref.Radar) -> Waveform:
    return Waveform(**asdict(radar))


@radars
def test_weights_are_their_definition(radar):
    d = ref.sample_weights(radar)
    assert np.abs(weights(waveform(radar)) - d).max() < ROUNDING * radar.n_adc
    assert noise_gain(waveform(radar)) == pytest.approx(np.sum(np.abs(d) ** 2), rel=ROUNDING)


@pytest.mark.parametrize(
    ("oversampling", "expected_db"), [(4, -48), (8, -71), (16, -95), (32, -118)]
)
def test_table_error_with_the_phase_reference_at_the_start(oversampling, expected_db):
    radar = RADARS["start"]
    table = hbs.HalfBandTable(waveform(radar), oversampling)
    error = ref.error_db(table(U), ref.half_band_sum(U, radar))
    assert error == pytest.approx(expected_db, abs=3)  # the trial of docs/physics/model.md


@given(
    samples=st.integers(2, 300),
    padding=st.integers(0, 60),
    centred=st.booleans(),
    window=st.sampled_from(["rectangular", "hann", "chebyshev"]),
    u=st.lists(st.floats(-2.5, 2.5), min_size=1, max_size=20),
)
def test_what_errors_are_measured_against_is_right(samples, padding, centred, window, u):
    """The table of quintics, against which every signal is compared, against the plain sum: they
    leave h^6/46080 of the sixth derivative."""
    shape = ChirpWindow(window if samples >= 3 else "rectangular")
    fft_length = 2 * ((samples + 1) // 2 + padding)
    w = Waveform(77e9, 1e9, 1e-4, samples * 1e4, 1e3, 1.0, fft_length, centred, window=shape)
    assert w.n_adc == samples
    d, n = weights(w), np.arange(samples) - w.n0
    right = np.exp(-2j * np.pi * np.outer(u, n)) @ d
    left = (2 * np.pi * np.abs(n) / (32 * samples)) ** 6 / 46080 + 1e-14 * samples
    assert np.abs(hbs.reference_table(w)(np.array(u)) - right).max() <= left @ np.abs(d)


@radars
def test_table_error_falls_with_the_fourth_power_of_the_oversampling(radar):
    right = ref.half_band_sum(U, radar)
    errors = [ref.error_db(hbs.HalfBandTable(waveform(radar), q)(U), right) for q in (4, 8, 16, 32)]
    assert errors[0] < -40
    assert np.diff(errors) == pytest.approx(-24.1, abs=3)


def test_centred_table_is_better_than_the_trial_by_far():
    """Around mid-chirp G turns half as fast, and its ends weigh next to nothing."""
    radar = RADARS["centre"]
    error = ref.error_db(hbs.HalfBandTable(waveform(radar), 16)(U), ref.half_band_sum(U, radar))
    assert error < -135


@pytest.mark.parametrize("name", ["centre", "odd", "odd, zero-padded"])
def test_sign_of_the_next_period(name):
    """|G| has period 1; G changes sign where n0 is half-integer, and only there."""
    table = hbs.HalfBandTable(waveform(RADARS[name]), 16)
    u = np.linspace(-0.99, 0.99, 101)
    sign = -1 if "odd" in name else 1
    rounding = 1e-10 * np.abs(table(u)).max()
    assert np.abs(table(u + 1) - sign * table(u)).max() < rounding
    assert np.abs(table(u + 2) - table(u)).max() < rounding


def test_table_is_continuous_across_the_seam_and_between_cells():
    table = hbs.HalfBandTable(waveform(RADARS["odd"]), 8)
    edges = np.arange(-8 * 41, 8 * 41 + 1) / (8 * 41)
    jump = np.abs(table(edges + 1e-9) - table(edges - 1e-9))
    # G cannot change by more than 2 pi N/2 max|G| du.
    assert jump.max() < 2e-9 * np.pi * 41 * np.abs(table(edges)).max() * 1.1


def test_table_is_shared_between_the_samples_of_a_radar():
    first = hbs.half_band_table(waveform(RADARS["centre"]), 16)
    assert hbs.half_band_table(waveform(ref.Radar()), 16) is first
    assert hbs.half_band_table(waveform(ref.Radar(centred=False)), 16) is not first


def receding_target(radar: ref.Radar, start: float, speed: float) -> np.ndarray:
    """Slow-time signal, by way of the beat matrix, of one point of amplitude 1."""
    delay = 2 * (start + speed * radar.times)[None] / ref.C
    beat = beat_matrix(delay, np.ones_like(delay), waveform(radar))
    return RangeSum(waveform(radar))(beat)[0]


@pytest.mark.parametrize(
    ("fc", "bandwidth", "start", "speed", "prf", "duration"),
    [(77e9, 4e9, 2.5, 3.0, 5000, 0.5), (2e9, 1e9, 10.0, 3.0, 500, 2.0)],
    ids=["77 GHz", "2 GHz"],
)
class TestWhereTheDopplerIsRead:
    """A target that crosses dozens of bins within the half-band (docs/physics/model.md)."""

    def lines(self, centred, fc, bandwidth, start, speed, prf, duration):
        """Frequencies, their level over the main line in dB, the line's place, and |y|."""
        radar = ref.Radar(fc, bandwidth, prf=prf, duration=duration, centred=centred)
        y = receding_target(radar, start, speed)
        power = np.abs(np.fft.fft(y * blackmanharris(y.size), 8 * y.size)) ** 2
        f = np.fft.fftfreq(power.size, 1 / prf)
        return f, 10 * np.log10(power / power.max()), f[power.argmax()], np.abs(y)

    def test_centre_gives_one_line_at_mid_chirp(self, fc, bandwidth, start, speed, prf, duration):
        f, level, line, envelope = self.lines(True, fc, bandwidth, start, speed, prf, duration)
        assert line == pytest.approx(-2 * speed * (fc + bandwidth / 2) / ref.C, abs=0.3 / duration)
        beside = np.abs(f - line) > 5 / duration  # the main lobe of the window is 4/T wide
        assert level[beside].max() < -50
        assert np.abs(envelope / envelope.mean() - 1).max() < 0.01

    def test_start_adds_a_ghost_at_the_end_of_the_chirp(
        self, fc, bandwidth, start, speed, prf, duration
    ):
        f, level, line, envelope = self.lines(False, fc, bandwidth, start, speed, prf, duration)
        doppler = -2 * speed * fc / ref.C
        assert line == pytest.approx(doppler, abs=0.3 / duration)
        ghost = np.abs(f - doppler * (1 + bandwidth / fc)) < 1 / duration
        assert level[ghost].max() == pytest.approx(-9, abs=1)
        assert envelope.max() / envelope.min() == pytest.approx(2, rel=0.15)
